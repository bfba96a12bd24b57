"""Light groups become further responses; too many are refused before anything is traced."""

from typing import Any

import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.layers import CHANNELS
from nocturne_scene.limits import MAX_FURTHER_RESPONSES
from nocturne_scene.responses import TAKEN_LAYERS, light_groups_in
from nocturne_scene.scene_ranges import schedule_of

from .conftest import Compile, expect_problem


def _grouped(document: dict[str, Any], **groups: str) -> dict[str, Any]:
    """With a sky of 'windows', and a lamp of its group."""
    document["environment"] = {"radiance": 1.0, "light_group": "windows"} | groups
    return document


def _counted(scene: scene_pb2.CompiledScene) -> dict[str, int | None]:
    return {
        each.name: each.light_group if each.HasField("light_group") else None
        for each in scene.sensor.further_responses
    }


def test_each_group_has_responses(document: dict[str, Any], compiled: Compile) -> None:
    document["surfaces"][1]["luminaire"]["light_group"] = "desk"
    scene = compiled(_grouped(document))
    found = _counted(scene)
    assert found == {
        **{f"desk.{axis}": 1 for axis in "XYZ"},
        **{f"windows.{axis}": 2 for axis in "XYZ"},
    }
    assert (scene.luminaires[0].light_group, scene.environment.light_group) == (1, 2)
    assert scene.format == 9
    curves = {each.name: list(each.values) for each in scene.sensor.further_responses}
    assert curves["desk.X"] == list(scene.sensor.response_x)
    assert curves["desk.Y"] == curves["windows.Y"] == list(scene.sensor.response_y)
    assert light_groups_in(list(found)) == ["desk", "windows"]


def test_lights_without_a_name_are_the_rest(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(_grouped(document))
    assert _counted(scene)["rest.Y"] == 0
    assert scene.luminaires[0].light_group == 0


def test_lights_in_groups_of_surfaces_name_theirs(document: dict[str, Any], compiled: Compile) -> None:
    """Each instance's lamp is of the same light group."""
    lamp = document["surfaces"].pop(1)
    lamp["luminaire"]["light_group"] = "row"
    document["groups"] = {"lamps": [lamp]}
    document["instances"] = [{"group": "lamps", "translate": [x, 0, 0]} for x in (0, 1)]
    scene = compiled(document)
    assert {each.light_group for each in scene.luminaires} == {1}
    assert set(_counted(scene)) == {"row.X", "row.Y", "row.Z"}


def test_without_names_nothing_is_told_apart(document: dict[str, Any], compiled: Compile) -> None:
    document["environment"] = {"radiance": 1.0}
    scene = compiled(document)
    assert not scene.sensor.further_responses
    assert scene.format < 7


def test_groups_change_no_wavelengths(document: dict[str, Any], compiled: Compile) -> None:
    """Lines have a separate density, which responses to all light change."""
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


@pytest.mark.parametrize(
    ("count", "named", "allowed"), [(20, True, True), (21, True, False), (20, False, False)]
)
def test_20_groups_are_the_most(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, count: int, *, named: bool, allowed: bool
) -> None:
    lamp = document["surfaces"].pop(1)
    lamps = [lamp | {"luminaire": lamp["luminaire"] | {"light_group": f"g{index}"}} for index in range(count)]
    document["surfaces"] += lamps if named else [*lamps, lamp]
    if allowed:
        assert len(compiled(document).sensor.further_responses) == 3 * 20 == MAX_FURTHER_RESPONSES
    else:
        rest = "" if named else ', one of them "rest" (lights without a name)'
        expect_problem(
            document,
            blobs,
            "$.sensor",
            f"21 light groups{rest}; at most 20, as each has three further responses",
        )


def test_the_schedule_has_their_names(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(_grouped(document))
    schedule = schedule_of(scene, 8, 8, 16)
    assert list(schedule.further_responses) == list(_counted(scene))
