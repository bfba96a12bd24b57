"""How large lamps without a size become."""

import numpy as np
import pytest
from nocturne_scene.formats.reading.extent import Extent

LAMP = np.array([0.0, 0.0, 1.0])


def _square(half: float) -> np.ndarray:
    return np.array([[-half, -half, 0.0], [half, half, 0.0]])


def test_a_lamp_is_a_thousandth_of_the_scene() -> None:
    extent = Extent()
    extent.add(_square(1.0))
    assert extent.lamp_radius(LAMP) == pytest.approx(1e-3 * np.hypot(2, 2))


def test_a_floor_to_the_horizon_does_not_make_a_lamp_that_reaches_it() -> None:
    extent = Extent()
    extent.add(_square(20.0))
    assert extent.lamp_radius(LAMP) == pytest.approx(0.01)


@pytest.mark.parametrize(("half", "radius"), [(1e3, 1e-4 * np.hypot(2e3, 2e3)), (1e6, 0.3)])
def test_a_lamp_is_large_enough_to_be_hit_from_huge_shapes(half: float, radius: float) -> None:
    extent = Extent()
    extent.add(_square(half))
    assert extent.lamp_radius(LAMP) == pytest.approx(radius)


def test_a_room_around_a_lamp_counts_by_its_size_alone() -> None:
    extent = Extent()
    extent.add(np.array([[-3.0, -2.0, 0.0], [3.0, 2.0, 3.0]]))
    assert extent.lamp_radius(LAMP) == pytest.approx(1e-3 * np.sqrt(36 + 16 + 9))


def test_without_shapes_there_is_a_size_too() -> None:
    assert Extent().lamp_radius(LAMP) == 1e-3
