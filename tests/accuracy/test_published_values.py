"""Every published value of media and of the sky is tested somewhere: which test has which.

The list of values, `../shared/accuracy/truth.json`, lies next to the repository, or those tests are skipped.
"""

import ast
import json
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.truths import truths as read_truths

_ROOT = Path(__file__).parents[2]
_TRUTHS = _ROOT.parent / "shared" / "accuracy" / "truth.json"

_BODIES, _SLABS = "accuracy/test_media_bodies.py", "accuracy/test_media_slabs.py"
_WALKS, _SKIES = "accuracy/test_media_walks.py", "accuracy/test_media_skies.py"
_COLOUR = "scene/test_published_colour.py"

# Identifiers as patterns, and the tests that have all of their values.
_TESTED: dict[str, list[tuple[str, str]]] = {
    "MED-HALF-*": [(_SLABS, "test_half_spaces")],
    "MED-MILNE": [(_BODIES, "test_the_law_of_darkening")],
    "MED-THICK-*": [
        (_BODIES, "test_a_very_thick_slab"),
        (_BODIES, "test_a_beam_through_a_thick_slab"),
    ],
    "MED-SLAB-*": [(_SLABS, "test_slabs"), (_SLABS, "test_light_that_nothing_scatters")],
    "MED-VDH-ANGULAR": [(_SLABS, "test_van_de_hulsts_slab_by_direction")],
    "MED-REFR-*": [
        (_SLABS, "test_slabs_with_a_smooth_surface"),
        (_SLABS, "test_the_surface_of_a_medium_alone"),
        (_SLABS, "test_a_half_space_lets_nothing_through"),
    ],
    "MED-GREEN-*": [(_WALKS, "test_fluence_around_a_point")],
    "MED-MOM-*": [(_WALKS, "test_moments_of_the_position")],
    "MED-BF-[123]": [(_BODIES, "test_mean_path_length")],
    "MED-BF-5": [(_BODIES, "test_mean_path_length_in_a_cylinder")],
    "MED-FURNACE": [
        (_BODIES, "test_white_furnace"),
        ("accuracy/test_media_furnaces.py", "test_meshes"),
        ("accuracy/test_media_furnaces.py", "test_instances_of_instances"),
        ("accuracy/test_media_furnaces.py", "test_phase_functions"),
        ("accuracy/test_media_furnaces.py", "test_a_cloud"),
    ],
    "MED-AIRLIGHT-*": [(_BODIES, "test_airlight")],
    "MED-BEER-*": [(_BODIES, "test_absorption")],
    "MED-HET-*": [
        ("accuracy/test_media_grids.py", "test_attenuation_through_a_gaussian"),
        (_BODIES, "test_absorption_that_grows_with_depth"),
        (_BODIES, "test_attenuation_through_air_around_a_planet"),
    ],
    # Those of the scalar equation; light is unpolarised here.
    "RAY-NATRAJ-*": [(_SKIES, "test_the_published_layer")],
    "RAY-SCALAR-*": [(_SKIES, "test_rayleigh_layers"), (_SKIES, "test_light_above_and_below_a_layer")],
    "RAY-TAU": [("scene/test_atmosphere.py", "test_straight_up_air_has_the_published_optical_depth")],
    "SUN-EXT": [
        (_COLOUR, "test_the_sun_has_its_illuminance"),
        (_COLOUR, "test_the_sun_is_that_of_the_standards_table"),
    ],
    "SKY-XYZ-*": [(_SKIES, "test_colours_of_the_sky")],
}

_IN_DATA = (
    "MED-SLAB-*",
    "MED-REFR-*",
    "MED-HALF-*",
    "MED-VDH-*",
    "MED-GREEN-*",
    "MED-MOM-*",
    "RAY-[NS]*",
    "SKY-*",
)


def test_the_tests_are_there() -> None:
    wanted = {test for tests in _TESTED.values() for test in tests}
    found = {
        (file, node.name)
        for file in {file for file, _ in wanted}
        for node in ast.parse((_ROOT / "tests" / file).read_text()).body
        if isinstance(node, ast.FunctionDef)
    }
    assert not wanted - found


@pytest.fixture
def truths() -> list[dict[str, Any]]:
    if not _TRUTHS.is_file():
        pytest.skip(f"there is no {_TRUTHS.relative_to(_ROOT.parent)} beside the repository")
    cases = json.loads(_TRUTHS.read_text())["cases"]
    return [case for case in cases if case["area"] in ("media", "rayleigh sky")]


def test_every_value_has_a_test(truths: list[dict[str, Any]]) -> None:
    names = [case["id"] for case in truths]
    assert names
    assert not [name for name in names if not any(fnmatch(name, pattern) for pattern in _TESTED)]
    assert not [pattern for pattern in _TESTED if not any(fnmatch(name, pattern) for name in names)]


def test_tables_of_values_are_whole(truths: list[dict[str, Any]]) -> None:
    """Each number of the list is one of validation/media.json, where tests take them from."""
    data = read_truths("media")
    here = np.array(list(_numbers(data)))
    for case in truths:
        if any(fnmatch(case["id"], pattern) for pattern in _IN_DATA):
            for number in _numbers(case["expected"]):
                assert np.isclose(here, number, rtol=1e-7, atol=0.0).any(), (case["id"], number)


def _numbers(value: Any) -> Iterator[float]:
    """All but those that tests compute: Beer's law, Fresnel's, and light that is polarised."""
    if isinstance(value, dict):
        for key, part in value.items():
            if key not in ("T_unscattered_normal", "spec") and not key.startswith("vector"):
                yield from _numbers(part)
    elif isinstance(value, list):
        for part in value:
            yield from _numbers(part)
    elif not isinstance(value, str):
        yield float(value)
