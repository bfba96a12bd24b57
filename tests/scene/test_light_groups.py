"""Light groups become further responses; what can't be told apart is refused before anything is traced."""

import itertools
from typing import Any

import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.layers import CHANNELS
from nocturne_scene.limits import MAX_FURTHER_RESPONSES
from nocturne_scene.ranges import make_schedule
from nocturne_scene.responses import TAKEN_LAYERS, light_groups_in
from nocturne_scene.scene_ranges import schedule_of
from nocturne_scene.tile_sums import numbers_in

from .conftest import Compile, expect_problem


def _grouped(document: dict[str, Any], **groups: str) -> dict[str, Any]:
    """With a sky of 'windows', and a lamp of its group."""
    document["environment"] = {"radiance": 1.0, "light_group": "windows"} | groups
    return document


def _counted(scene: scene_pb2.CompiledScene) -> dict[str, list[int]]:
    return {each.name: list(each.light_groups) for each in scene.sensor.further_responses}


def test_each_group_and_each_two_have_responses(document: dict[str, Any], compiled: Compile) -> None:
    document["surfaces"][1]["luminaire"]["light_group"] = "desk"
    scene = compiled(_grouped(document))
    found = _counted(scene)
    assert found == {
        **{f"desk.{axis}": [1] for axis in "XYZ"},
        **{f"windows.{axis}": [2] for axis in "XYZ"},
        "desk+windows.Y": [1, 2],
    }
    assert (scene.luminaires[0].light_group, scene.environment.light_group) == (1, 2)
    assert scene.format == 7
    curves = {each.name: list(each.values) for each in scene.sensor.further_responses}
    assert curves["desk.X"] == list(scene.sensor.response_x)
    assert curves["desk+windows.Y"] == curves["windows.Y"] == list(scene.sensor.response_y)
    assert light_groups_in(list(found)) == ["desk", "windows"]


def test_lights_without_a_name_are_the_rest(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(_grouped(document))
    assert _counted(scene)["rest.Y"] == [0]
    assert _counted(scene)["windows+rest.Y"] == [1, 0]
    assert scene.luminaires[0].light_group == 0


def test_without_names_nothing_is_told_apart(document: dict[str, Any], compiled: Compile) -> None:
    document["environment"] = {"radiance": 1.0}
    scene = compiled(document)
    assert not scene.sensor.further_responses
    assert scene.format < 7


def test_groups_change_no_wavelengths(document: dict[str, Any], compiled: Compile) -> None:
    """Lines have a density of their own, which responses to all light change."""
    document["surfaces"][1]["luminaire"]["radiance"] = {"lines": [{"nm": 546.1, "power": 1.0}]}
    before = compiled(document).sensor
    document["surfaces"][1]["luminaire"]["light_group"] = "desk"
    after = compiled(document).sensor
    assert list(before.wavelength_knots) == list(after.wavelength_knots)
    assert list(before.wavelength_density) == list(after.wavelength_density)


@pytest.mark.parametrize("name", ["rest", "direct", "albedo", "X", "a b", "1st", "a.b", "a" * 32])
def test_names_that_mean_other_channels_are_refused(
    document: dict[str, Any], blobs: BlobStore, name: str
) -> None:
    document["surfaces"][1]["luminaire"]["light_group"] = name
    with pytest.raises(AssertionError):
        expect_problem(document, blobs, "$", "never")


def test_layers_are_no_groups() -> None:
    assert {name.split(".")[0] for names in CHANNELS.values() for name in names} <= TAKEN_LAYERS


def test_31_groups_are_the_most(document: dict[str, Any], compiled: Compile, blobs: BlobStore) -> None:
    lamp = document["surfaces"][1]
    for count, allowed in ((31, True), (32, False)):
        lamps = [
            lamp | {"luminaire": lamp["luminaire"] | {"light_group": f"g{index}"}} for index in range(count)
        ]
        document["surfaces"][1:] = lamps
        if allowed:
            assert (
                len(compiled(document).sensor.further_responses)
                == 31 * 3 + 31 * 30 // 2
                <= MAX_FURTHER_RESPONSES
            )
        else:
            expect_problem(document, blobs, "$.sensor", "32 light groups need 592 further channels")


def test_a_film_of_many_groups_is_refused_before_it_takes_memory() -> None:
    """The largest film has as many sums in all: 2^26 pixels of 9."""
    names = [f"g{index}.{axis}" for index in range(8) for axis in "XYZ"]
    names += [f"g{a}+g{b}.Y" for a, b in itertools.combinations(range(8), 2)]
    assert make_schedule(2048, 2048, 16, names).tile_size == 8
    with pytest.raises(Exception, match="pixels; at most 5344953"):
        make_schedule(4096, 2048, 16, names)
    assert 8 * numbers_in(8, 8, len(names)) < 144 * 1024


def test_the_schedule_has_their_names(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(_grouped(document))
    schedule = schedule_of(scene, 8, 8, 16)
    assert list(schedule.further_responses) == list(_counted(scene))
