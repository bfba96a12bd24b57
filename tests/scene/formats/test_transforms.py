"""Turns of scene formats, taken apart."""

import numpy as np
import pytest
from nocturne_scene.formats.reading import transforms

AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, -3), (-1, 1e-3, 0)]


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("degrees", [1e-6, 30.0, 90.0, 179.999999, 180.0])
def test_a_rotation_has_the_axis_and_angle_it_was_made_of(
    axis: tuple[float, float, float], degrees: float
) -> None:
    found = transforms.rotation_of(transforms.rotation(axis, degrees)[:3, :3])
    assert found is not None
    # Half a turn about an axis is half a turn about its opposite.
    made = transforms.rotation(*found)
    assert made == pytest.approx(transforms.rotation(axis, degrees), abs=1e-12)
    assert found[1] == pytest.approx(degrees, rel=1e-6)
    assert np.linalg.norm(found[0]) == pytest.approx(1.0, abs=1e-12)


def test_the_identity_turns_about_nothing() -> None:
    assert transforms.rotation_of(np.eye(3)) is None
