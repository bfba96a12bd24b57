"""The pilot's decisions, and their effect on the compiled scene. Long, as each choice has its cases."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import ways
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.compile.output import CompiledOutput
from nocturne_scene.compile.unmet import unmet_light, unmet_parts
from nocturne_scene.document.read import parse_document
from nocturne_scene.film import Film
from nocturne_scene.render_warnings import UnmetPart, from_messages
from nocturne_scene.scene_ranges import schedule_for_scene

from tests.accuracy.window_rooms import SCENES

LARGE, SMALL = Film(64, 64, 64), Film(64, 64, 63)


def compiled(
    document: dict[str, Any], blobs: BlobStore, film: Film | None
) -> tuple[CompiledOutput, scene_pb2.Tracing]:
    output = compile_scene(parse_document(json.dumps(document)), blobs, film)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    return output, scene.tracing


class Asked:
    """Stands for nocturne-trace: keeps its requests, and answers the same each time."""

    def __init__(
        self,
        monkeypatch: pytest.MonkeyPatch,
        *,
        forward: bool = False,
        sharing: int = 1,
        ratio: float = 1.0,
        gain: float = 7.5,
        gain_error: float = 0.1,
        fault: str = "",
        aims: Sequence[dict[str, Any]] = (),
        learned_light: bytes = b"",
        visible_sky: bytes = b"",
    ) -> None:
        self.asked: list[tuple[list[str], scene_pb2.Tracing]] = []
        self.answer: dict[str, Any] = {
            "forward_photons": forward,
            "sharing": sharing,
            "forward_ratio": ratio,
            "gain": gain,
            "gain_error": gain_error,
            "fault": fault,
            "differs_by": 0.38 if fault else 0.0,
            "finds_more": False,
            "aimed": 0.6 if forward else 0.0,
            "unmet": 0.0,
            "unmet_parts": [],
            "aims": list(aims),
            "learned_light": learned_light.hex(),
            "visible_sky": visible_sky.hex(),
            "photons": 123456,
        }

        def run(
            program: Path, scene: scene_pb2.CompiledScene, blobs: Path, film: Film, chosen: list[str]
        ) -> dict[str, Any]:
            del program, blobs, film
            copy = scene_pb2.Tracing()
            copy.CopyFrom(scene.tracing)
            self.asked.append((list(chosen), copy))
            return self.answer

        monkeypatch.setattr(ways, "_run", run)
        monkeypatch.setattr(ways, "find_program", lambda name: Path(name))


def test_what_is_left_open_is_asked_for_once(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch, forward=True, sharing=16)
    output, tracing = compiled(document, blobs, LARGE)
    [(chosen, asked)] = trace.asked
    assert chosen == ["direction", "ratio", "learn", "guide", "sharing"]
    assert asked.direction == scene_pb2.DIRECTION_BOTH
    assert (tracing.direction, tracing.sharing) == (scene_pb2.DIRECTION_BOTH, 16)
    assert output.way == tracing.way
    assert output.way.startswith(
        "photons from both directions, shared by blocks of 16 pixels: 6.2 to 9.1 times less time"
    )


def test_a_gain_that_is_hardly_known_is_not_told(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    Asked(monkeypatch, forward=True, gain=166.0, gain_error=1.5)
    output, _ = compiled(document, blobs, LARGE)
    assert output.way.startswith("photons from both directions: less time to the same error than")


def test_a_way_that_brings_other_light_is_told_as_a_fault(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    Asked(monkeypatch, fault="shared")
    output, tracing = compiled(document, blobs, LARGE)
    assert tracing.sharing == 1
    [told] = output.warnings
    assert told.kind == "fault"
    assert told.sentence.startswith("pixels that share brought 38% more light than others")
    assert "a fault of the program" in told.sentence
    assert "fault" not in output.way


def test_no_gain_is_told_that_is_none(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    Asked(monkeypatch, forward=True, gain=0.8)
    output, _ = compiled(document, blobs, LARGE)
    assert output.way == (
        "photons from both directions: about as much error as by photons from the sensor, which may miss "
        "light, by a pilot of 123,456 photons"
    )


@pytest.mark.parametrize(
    ("ratio", "said"),
    [
        (8.0, "(8 from the luminaires for each from the sensor)"),
        (0.25, "(4 from the sensor for each from the luminaires)"),
    ],
)
def test_a_pilot_says_how_many_photons_leave_the_luminaires(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch, ratio: float, said: str
) -> None:
    Asked(monkeypatch, forward=True, ratio=ratio)
    output = compile_scene(parse_document(json.dumps(document)), blobs, LARGE)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    # An older program would take each tile's photons for all there are.
    assert (scene.tracing.forward_ratio, scene.format) == (ratio, 5)
    assert output.way.startswith(f"photons from both directions {said}: ")


def test_a_ratio_is_for_photons_that_go_both_ways(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    Asked(monkeypatch, forward=False)
    output, tracing = compiled({**document, "tracing": {"forward_ratio": 4}}, blobs, LARGE)
    assert (tracing.forward_ratio, output.dropped) == (0.0, [])
    told = {"direction": "adjoint", "forward_ratio": 4}
    output, tracing = compiled({**document, "tracing": told}, blobs, LARGE)
    assert tracing.forward_ratio == 0.0
    assert output.dropped == ["$.tracing.forward_ratio: photons do not go both ways"]


def test_nothing_is_asked_for_a_small_image_or_an_unknown_film(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch, forward=True, sharing=16)
    for film in (None, SMALL):
        output, tracing = compiled(document, blobs, film)
        assert (tracing.direction, tracing.sharing) == (scene_pb2.DIRECTION_ADJOINT, 1)
        assert output.way == ""
    assert trace.asked == []


def test_of_a_small_image_with_glass_is_asked_whether_light_is_missed(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch, forward=True)
    document["kernels"]["white"] = {"type": "dielectric", "index": 1.5}
    compiled(document, blobs, SMALL)
    assert [chosen for chosen, _ in trace.asked] == [["parts", "direction", "ratio", "learn"]]
    # One sample tells no error that could be too small.
    compiled(document, blobs, Film(64, 64, 1))
    assert len(trace.asked) == 1


def test_parts_that_are_not_to_be_trusted_are_named_whatever_the_document_chose(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch)
    document["kernels"]["white"] = {"type": "dielectric", "index": 1.5}
    document["tracing"] = {"direction": "adjoint", "sharing": 1, "guide": "none"}
    output, _ = compiled(document, blobs, LARGE)
    assert ([chosen for chosen, _ in trace.asked], output.way) == ([["parts"]], "")
    trace.answer["unmet_parts"] = [[8, 16, 4, 4, 0.3], [12, 20, 4, 4, 25.0], [40, 40, 4, 4, 0.05]]
    output, tracing = compiled(document, blobs, LARGE)
    # Nothing was to be chosen.
    assert output.way == ""
    [told] = output.warnings
    assert told.kind == "missing_in_parts"
    assert told.sentence.startswith(
        "reflections, refractions or caustics of small bright light sources may be"
    )
    assert told.sentence.endswith(
        "at pixels x 8 to 15 y 16 to 23 (up to 25 times the light shown there), "
        "x 40 to 43 y 40 to 43 (up to 5%)"
    )
    # The pixels themselves, which touch at a corner only.
    assert told.parts == (
        UnmetPart(8, 16, 4, 4, 0.3),
        UnmetPart(12, 20, 4, 4, 25.0),
        UnmetPart(40, 40, 4, 4, 0.05),
    )
    assert from_messages(tracing.warnings) == (told,)
    schedule = schedule_for_scene(blobs, output.scene_sha256, LARGE.width, LARGE.height, LARGE.samples)
    assert list(schedule.warnings) == list(tracing.warnings)


def test_how_much_of_the_mean_may_be_missing_is_told(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch)
    trace.answer["unmet"] = 0.02
    output, _ = compiled(document, blobs, LARGE)
    assert [(each.kind, each.parts) for each in output.warnings] == [("missing_light", ())]
    assert "up to 2.0% of the mean may be missing" in output.warnings[0].sentence
    assert unmet_light(0.004) is None


def test_parts_are_told_by_few_rectangles_of_the_same_pixels() -> None:
    """A row's neighbours and equal rows become one; a pilot's pixels are not all of one size."""
    warning = unmet_parts([[8 * x, 6 * y, 8, 6, 0.1 + x] for x in (0, 1, 2, 4) for y in (0, 1, 2)])
    assert warning is not None
    assert warning.parts == (UnmetPart(0, 0, 24, 18, 2.1), UnmetPart(32, 0, 8, 18, 4.1))
    board = [[x, y, 1, 1, 0.1] for x in range(60) for y in range(60) if (x + y) % 2 == 0]
    warning = unmet_parts(board)
    assert warning is not None
    assert len(warning.parts) <= 200
    film = np.zeros((60, 60), dtype=np.bool_)
    for each in warning.parts:
        film[each.pixels] = True
        assert each.x + each.width <= 60
        assert each.y + each.height <= 60
    assert all(film[int(y), int(x)] for x, y, *_ in board)


def test_parts_beyond_the_largest_are_counted() -> None:
    many = [[20 * i, 0, 8 - i, 1, 0.1 * (i + 1)] for i in range(8)]
    warning, fewer = unmet_parts(many), unmet_parts(many[:6])
    assert warning is not None
    assert fewer is not None
    said = warning.sentence
    assert "at pixels x 0 to 7 y 0 (up to 10% of the light shown there), x 20 to 26 y 0 (up to 20%)" in said
    assert said.endswith("x 80 to 83 y 0 (up to 50%), 3 smaller areas within x 100 to 140 y 0 (up to 80%)")
    assert fewer.sentence.endswith(", 1 smaller area within x 100 to 102 y 0 (up to 60%)")
    assert [(each.x, each.width) for each in warning.parts] == [(20 * i, 8 - i) for i in range(8)]
    assert unmet_parts([]) is None
    nothing_seen = unmet_parts([[0, 0, 8, 6, 1e9]])
    assert nothing_seen is not None
    assert "(up to any number of times the light shown there)" in nothing_seen.sentence


@pytest.mark.parametrize(
    ("tracing", "chosen"),
    [
        ({"direction": "adjoint"}, [["sharing"]]),
        ({"sharing": 16}, [["direction", "ratio", "learn", "guide"]]),
        ({"sharing": 16, "aimed_emission": 0, "forward_ratio": 2, "guide": "none"}, [["direction"]]),
        ({"direction": "both", "sharing": 1}, [["guide"]]),
        ({"direction": "both", "sharing": 1, "guide": "none"}, []),
        ({"estimator": "mixture"}, [["direction", "ratio", "learn", "guide"]]),
    ],
)
def test_what_the_document_says_is_taken(
    document: dict[str, Any],
    blobs: BlobStore,
    monkeypatch: pytest.MonkeyPatch,
    tracing: dict[str, Any],
    chosen: list[list[str]],
) -> None:
    trace = Asked(monkeypatch)
    _, found = compiled({**document, "tracing": tracing}, blobs, LARGE)
    assert [names for names, _ in trace.asked] == chosen
    if "sharing" in tracing:
        assert found.sharing == tracing["sharing"]
    if tracing.get("direction") == "both":
        assert found.direction == scene_pb2.DIRECTION_BOTH


def test_photons_start_at_spheres_in_groups_but_not_for_too_large_films(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch)
    sphere = {"type": "sphere", "centre": [0, 0, 0], "radius": 1}
    lamp = {"shape": sphere, "kernel": {"type": "lambertian", "reflectance": 0.5}}
    lamp["luminaire"] = {"radiance": {"blackbody": 3000}}
    grouped = {**document, "groups": {"lamps": [lamp]}, "instances": [{"group": "lamps"}]}
    compiled(grouped, blobs, LARGE)
    compiled(document, blobs, Film(8192, 4096, 64))
    assert [chosen for chosen, _ in trace.asked] == [
        ["direction", "ratio", "learn", "guide", "sharing"],
        ["sharing"],
    ]


def test_photons_may_start_at_luminaires_for_a_large_film(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch, forward=True)
    _, tracing = compiled(document, blobs, Film(1920, 1080, 64))
    assert [chosen for chosen, _ in trace.asked] == [["direction", "ratio", "learn", "guide", "sharing"]]
    assert tracing.direction == scene_pb2.DIRECTION_BOTH


def test_a_meter_may_be_met_by_photons_and_they_are_aimed(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    meter = {
        "type": "irradiance_meter",
        "position": [0, 0, 3],
        "normal": [0, 0, -1],
        "up": [0, 1, 0],
        "height": 1,
    }
    ball = {"shape": {"type": "sphere", "centre": [0, 0, 2], "radius": 0.5}}
    changed = {**document, "sensor": meter, "important_directions": [ball]}
    trace = Asked(monkeypatch, forward=True)
    _, tracing = compiled(changed, blobs, LARGE)
    assert [chosen for chosen, _ in trace.asked] == [["direction", "aim"]]
    assert tracing.direction == scene_pb2.DIRECTION_FORWARD
    assert tracing.aimed_emission == 0.6
    # Adjoint photons have no use for that.
    Asked(monkeypatch, forward=False)
    assert compiled(changed, blobs, LARGE)[1].aimed_emission == 0.0


def test_photons_are_aimed_at_what_was_learned(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    aim = {"centre": [0.1, 0.2, 0.3], "radius": 0.4, "weight": 2.5}
    Asked(monkeypatch, forward=True, aims=[aim])
    output = compile_scene(parse_document(json.dumps(document)), blobs, LARGE)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    [shape] = scene.important_shapes
    centre = shape.sphere.centre
    assert [centre.x, centre.y, centre.z, shape.sphere.radius, shape.weight] == [0.1, 0.2, 0.3, 0.4, 2.5]
    assert scene.tracing.aimed_emission == 0.6
    # Photons from the sensor are not sent there.
    assert scene.tracing.weight_important == 0.0
    assert output.way.startswith("photons from both directions, aimed at what was learned")


def test_important_directions_keep_their_weight(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    ball = {"shape": {"type": "sphere", "centre": [0, 0, 2], "radius": 0.5}}
    declared = {**document, "important_directions": [ball]}
    trace = Asked(monkeypatch, forward=True)
    _, tracing = compiled(declared, blobs, LARGE)
    [(chosen, asked)] = trace.asked
    assert chosen == ["direction", "ratio", "aim", "guide", "sharing"]
    assert (asked.weight_important, asked.weight_luminaires) == (0.175, 0.175)
    assert (tracing.weight_important, tracing.weight_luminaires) == (0.175, 0.175)
    assert tracing.aimed_emission == 0.6

    trace = Asked(monkeypatch, forward=True)
    told = {"mixture": {"important": 1}, "aimed_emission": 0.123456789}
    _, tracing = compiled({**declared, "tracing": told}, blobs, LARGE)
    assert "aim" not in trace.asked[0][0]
    # The pilot prints six digits.
    assert tracing.aimed_emission == 0.123456789
    assert tracing.weight_important > 0.5


def test_photons_are_guided_by_what_was_learned(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    Asked(monkeypatch, forward=True, learned_light=bytes(range(16)))
    output = compile_scene(parse_document(json.dumps(document)), blobs, LARGE)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    # An older program would not look at it, and make other bits.
    assert (scene.learned_light, scene.format) == (bytes(range(16)), 6)
    assert output.way.startswith("photons from both directions, guided by what was learned: ")


def test_photons_know_which_sky_is_visible(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    document["environment"] = {"radiance": 1.0}
    trace = Asked(monkeypatch, gain=1.0, visible_sky=bytes(range(16)))
    output = compile_scene(parse_document(json.dumps(document)), blobs, LARGE)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    assert "sky" in trace.asked[0][0]
    assert (scene.visible_sky, scene.format) == (bytes(range(16)), 8)
    assert output.way.startswith("photons from the sensor, that know which sky is visible: no other method")
    # Where there is none, where nobody is to be guided, and where nothing is drawn towards the sky.
    for left_out in ({"guide": "none"}, {"estimator": "mixture"}):
        compiled({**document, "tracing": left_out}, blobs, LARGE)
        assert "sky" not in (trace.asked[-1][0] if len(trace.asked) > 1 else [])
        del trace.asked[1:]


def test_the_real_tracer_learns_which_sky_is_visible_in_a_room(blobs: BlobStore) -> None:
    """And nothing where there are no walls."""
    room = SCENES["even sky"]
    outputs = [compile_scene(parse_document(json.dumps(room)), blobs, LARGE) for _ in range(2)]
    assert outputs[0] == outputs[1]
    scene = scene_pb2.CompiledScene.FromString(blobs.path(outputs[0].scene_sha256).read_bytes())
    assert 16 * 100 < len(scene.visible_sky) <= 65_536 * 16
    _, tracing = compiled({**room, "surfaces": room["surfaces"][:1]}, blobs, LARGE)
    assert "visible" not in tracing.way


def test_the_real_tracer_guides_photons_to_a_lamp_above_water(
    document: dict[str, Any], blobs: BlobStore
) -> None:
    water = {"type": "box", "minimum": [-1, -1, -0.1], "maximum": [1, 1, 0.5]}
    lamp = {"shape": {"type": "sphere", "centre": [0.3, 0.2, 1.5], "radius": 0.02}}
    document["sensor"] = {
        "type": "pinhole",
        "position": [0, -3, 2.5],
        "look_at": [0, 0, 0],
        "up": [0, 0, 1],
        "vertical_field_of_view_degrees": 30,
    }
    document["surfaces"] = [
        {
            "shape": {"type": "quad", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]},
            "kernel": {"type": "lambertian", "reflectance": 0.5},
        },
        {"shape": water, "kernel": {"type": "dielectric", "index": 1.33}},
        {
            **lamp,
            "kernel": {"type": "lambertian", "reflectance": 0},
            "luminaire": {"radiance": {"blackbody": 5500}},
        },
    ]
    outputs = [compile_scene(parse_document(json.dumps(document)), blobs, LARGE) for _ in range(2)]
    assert outputs[0] == outputs[1]
    assert ", guided by what was learned" in outputs[0].way
    scene = scene_pb2.CompiledScene.FromString(blobs.path(outputs[0].scene_sha256).read_bytes())
    assert 0 < len(scene.learned_light) <= 65_536 * 16


def test_the_real_tracer_aims_at_the_glass_that_makes_a_caustic(blobs: BlobStore) -> None:
    glass = {"shape": {"type": "sphere", "centre": [0, 0, 0.09], "radius": 0.03}}
    glass["kernel"] = {"type": "dielectric", "index": 1.5}
    lamp = {"shape": {"type": "sphere", "centre": [0.1, 0, 0.6], "radius": 0.01}}
    lamp |= {
        "kernel": {"type": "lambertian", "reflectance": 0},
        "luminaire": {"radiance": {"blackbody": 5500}},
    }
    meter = {
        "type": "irradiance_meter",
        "position": [0, 0, 0],
        "normal": [0, 0, 1],
        "up": [0, 1, 0],
        "height": 0.12,
    }
    document = {"nocturne": 1, "sensor": meter, "surfaces": [glass, lamp]}
    outputs = [compile_scene(parse_document(json.dumps(document)), blobs, LARGE) for _ in range(2)]
    assert outputs[0] == outputs[1]
    scene = scene_pb2.CompiledScene.FromString(blobs.path(outputs[0].scene_sha256).read_bytes())
    assert scene.tracing.direction == scene_pb2.DIRECTION_FORWARD
    assert scene.tracing.aimed_emission == 0.6
    # Film and glass, not all the scene.
    assert 1 <= len(scene.important_shapes) <= 16
    assert all(shape.sphere.radius < 0.2 for shape in scene.important_shapes)


def test_without_the_tracer_nothing_is_chosen_and_that_is_said(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ways, "find_program", lambda _: None)
    output, tracing = compiled(document, blobs, LARGE)
    assert (tracing.direction, tracing.sharing) == (scene_pb2.DIRECTION_ADJOINT, 1)
    assert "nocturne-trace is missing" in output.way


def test_a_pilot_that_fails_is_no_failure_of_the_scene(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    broken = tmp_path / "nocturne-trace"
    broken.write_text("#!/bin/sh\nexit 3\n")
    broken.chmod(0o700)
    monkeypatch.setattr(ways, "find_program", lambda _: broken)
    output, tracing = compiled(document, blobs, LARGE)
    assert (tracing.direction, tracing.sharing) == (scene_pb2.DIRECTION_ADJOINT, 1)
    assert "the pilot failed" in output.way


def test_the_real_tracer_answers_and_always_the_same(document: dict[str, Any], blobs: BlobStore) -> None:
    outputs = [compiled(document, blobs, LARGE)[0] for _ in range(2)]
    assert "by a pilot of" in outputs[0].way
    assert outputs[0] == outputs[1]
