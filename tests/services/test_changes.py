"""Changes of a scene document by their places, as `--set` and `--bands` make them."""

import json
from pathlib import Path
from typing import Any

import pytest
from nocturne_client.cli.scene_options import (
    changes_of,
    layer_names,
    parse_bands,
    parse_change,
    parse_frames,
    parse_variants,
)
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import compile_to
from nocturne_scene.document.changes import changed
from nocturne_scene.errors import InputError

DOCUMENT: dict[str, Any] = {"sensor": {"position": [0, 0, 4]}, "surfaces": [{"kernel": {"reflectance": 0.5}}]}


@pytest.mark.parametrize(
    ("text", "way", "value"),
    [
        ("sensor.position[0]=1.5", ("sensor", "position", 0), 1.5),
        ("$.surfaces[0].kernel.reflectance=white", ("surfaces", 0, "kernel", "reflectance"), "white"),
        ("tracing.seed=7", ("tracing", "seed"), 7),
        ("sensor.up=[0, 0, 1]", ("sensor", "up"), [0, 0, 1]),
    ],
)
def test_put_a_value_in_its_place(text: str, way: tuple[str | int, ...], value: object) -> None:
    made: Any = changed(DOCUMENT, dict([parse_change(text)]))
    for step in way:
        made = made[step]
    assert made == value
    assert DOCUMENT["sensor"] == {"position": [0, 0, 4]}


@pytest.mark.parametrize("text", ["sensor", "=3"])
def test_without_a_place_are_told(text: str) -> None:
    with pytest.raises(NocturneClientError):
        parse_change(text)


@pytest.mark.parametrize("place", ["surfaces[4].kernel", "sensor[0]", "a b!", "", "sensor.position.x"])
def test_of_no_place_are_told(place: str) -> None:
    with pytest.raises(InputError) as refused:
        changed(DOCUMENT, {place: 1})
    assert [each.place for each in refused.value.problems] == [place]


def test_variants_are_values_between_commas() -> None:
    assert parse_variants("tracing.seed=1,2") == ("tracing.seed", [1, 2])
    assert parse_variants("a.reflectance=0.2, white") == ("a.reflectance", [0.2, "white"])
    assert parse_variants("sensor.look_at=[0, 0, 0], [1, 0, 0]") == ("sensor.look_at", [[0, 0, 0], [1, 0, 0]])


@pytest.mark.parametrize("text", ["1", "a-b", "-1-2"])
def test_frames_that_are_none_are_told(text: str) -> None:
    assert parse_frames("8-12") == (8, 12)
    with pytest.raises(NocturneClientError, match="expected FIRST-LAST"):
        parse_frames(text)


def test_bands_are_the_sensors() -> None:
    assert parse_bands("380:780:10") == {"sensor.bands": {"first": 380, "last": 780, "width": 10}}
    with pytest.raises(NocturneClientError, match="expected FIRST:LAST:WIDTH"):
        parse_bands("380-780")
    assert changes_of(["a.b=1"], "", "") == {"a.b": 1}


def test_all_layers_have_a_word() -> None:
    assert len(layer_names("all")) == 7
    assert layer_names(" depth, albedo") == ("depth", "albedo")


def test_a_change_that_makes_no_scene_is_told_with_its_place(scene: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    with pytest.raises(NocturneClientError) as refused:
        compile_to(tmp_path / "scene.json", tmp_path, 8, 8, 4, changes={"sensor.position[1]": "high"})
    assert [each.place for each in refused.value.problems] == ["$.sensor.position[1]"]


def test_parts_of_the_light_are_the_sensors_and_no_layers() -> None:
    assert changes_of(None, "", "albedo, direct") == {"sensor.light_parts": True}
    assert layer_names("albedo, direct,indirect") == ("albedo",)
    assert changes_of(None, "", "albedo") == {}
