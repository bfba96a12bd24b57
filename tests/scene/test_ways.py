"""What is left to a pilot, and what becomes of its choice."""

import json
from pathlib import Path
from typing import Any

import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import ways
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.compile.output import CompiledOutput
from nocturne_scene.document.read import parse_document
from nocturne_scene.film import Film

LARGE, SMALL = Film(256, 256, 256), Film(64, 64, 64)


def compiled(
    document: dict[str, Any], blobs: BlobStore, film: Film | None
) -> tuple[CompiledOutput, scene_pb2.Tracing]:
    output = compile_scene(parse_document(json.dumps(document)), blobs, film)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    return output, scene.tracing


class Asked:
    """Stands for nocturne-trace: keeps what it was asked, and answers the same each time."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *, forward: bool = False, sharing: int = 1) -> None:
        self.asked: list[tuple[list[str], scene_pb2.Tracing]] = []
        answer = {
            "forward_photons": forward,
            "sharing": sharing,
            "gain": 7.5,
            "finds_more": False,
            "aimed": forward,
            "photons": 123456,
        }

        def run(
            program: Path, scene: scene_pb2.CompiledScene, blobs: Path, film: Film, chosen: list[str]
        ) -> dict[str, Any]:
            del program, blobs, film
            copy = scene_pb2.Tracing()
            copy.CopyFrom(scene.tracing)
            self.asked.append((list(chosen), copy))
            return answer

        monkeypatch.setattr(ways, "_run", run)
        monkeypatch.setattr(ways, "find_program", lambda name: Path(name))


def test_what_is_left_open_is_asked_for_once(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch, forward=True, sharing=16)
    output, tracing = compiled(document, blobs, LARGE)
    [(chosen, asked)] = trace.asked
    assert chosen == ["direction", "sharing"]
    assert asked.direction == scene_pb2.DIRECTION_BOTH
    assert (tracing.direction, tracing.sharing) == (scene_pb2.DIRECTION_BOTH, 16)
    assert output.way == tracing.way
    assert output.way.startswith(
        "photons from both directions, shared by blocks of 16 pixels: 7.5 times less time"
    )


def test_nothing_is_asked_for_a_small_image_or_an_unknown_film(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch, forward=True, sharing=16)
    for film in (None, SMALL):
        output, tracing = compiled(document, blobs, film)
        assert (tracing.direction, tracing.sharing) == (scene_pb2.DIRECTION_ADJOINT, 1)
        assert output.way == ""
    assert trace.asked == []


@pytest.mark.parametrize(
    ("tracing", "chosen"),
    [
        ({"direction": "adjoint"}, [["sharing"]]),
        ({"sharing": 4}, [["direction"]]),
        ({"direction": "both", "sharing": 1}, []),
        ({"estimator": "mixture"}, [["direction"]]),
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


def test_photons_start_at_luminaires_only_where_they_can(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch)
    sphere = {"type": "sphere", "centre": [0, 0, 0], "radius": 1}
    lamp = {"shape": sphere, "kernel": {"type": "lambertian", "reflectance": 0.5}}
    lamp["luminaire"] = {"radiance": {"blackbody": 3000}}
    grouped = {**document, "groups": {"lamps": [lamp]}, "instances": [{"group": "lamps"}]}
    compiled(grouped, blobs, LARGE)
    # Nor on films that are too large for them.
    compiled(document, blobs, Film(8192, 4096, 64))
    assert [chosen for chosen, _ in trace.asked] == [["sharing"], ["sharing"]]


def test_photons_may_start_at_luminaires_for_a_large_film(
    document: dict[str, Any], blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = Asked(monkeypatch, forward=True)
    _, tracing = compiled(document, blobs, Film(1920, 1080, 64))
    assert [chosen for chosen, _ in trace.asked] == [["direction", "sharing"]]
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
    assert tracing.aimed_emission == 0.9
    # Adjoint photons have no use for that.
    Asked(monkeypatch, forward=False)
    assert compiled(changed, blobs, LARGE)[1].aimed_emission == 0.0


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
