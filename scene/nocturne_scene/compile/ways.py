"""Which way a scene is traced where its document leaves that open: a pilot of a few samples tells.

docs/decisions/0062: `nocturne-trace --pilot` traces a small part of the render's samples by each way that
applies, and compares errors for the same cost. Costs are counted, not timed, so that the choice, like the
image, is a function of scene, film and samples.
"""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nocturne.v1 import scene_pb2

from nocturne_scene.compile.trace_program import run_trace
from nocturne_scene.document.checks import CAMERAS, MET_BY_PHOTONS
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film
from nocturne_scene.programs import find_program
from nocturne_scene.scene_ranges import schedule_of

WORTH_A_PILOT = 2**21
"""Samples of a whole film: what takes a second or two needs no choice."""

MAX_SECONDS = 120.0
"""After which a pilot is given up."""

_AIMED = 0.9
"""Part of the photons from luminaires that goes to what a person declared important."""

_EXACT_BELOW = 10

DIRECTIONS = {
    "adjoint": scene_pb2.DIRECTION_ADJOINT,
    "forward": scene_pb2.DIRECTION_FORWARD,
    "both": scene_pb2.DIRECTION_BOTH,
}
_SAID = {
    "adjoint": "photons from the sensor",
    "forward": "photons from the luminaires",
    "both": "photons from both directions",
}


@dataclass(frozen=True)
class Ways:
    """How photons are traced; where nobody says anything, as this has it."""

    direction: str = "adjoint"
    sharing: int = 1
    aimed_emission: float = 0.0

    def named(self) -> str:
        """In words."""
        shared = f", shared by blocks of {self.sharing} pixels" if self.sharing > 1 else ""
        return f"{_SAID[self.direction]}{shared}"


def given_ways(document: SceneDocument) -> Ways:
    """What the document says, and without a pilot for what it leaves open."""
    tracing = document.tracing
    return Ways(
        "adjoint" if tracing.direction == "auto" else tracing.direction,
        1 if tracing.sharing == "auto" else tracing.sharing,
        tracing.aimed_emission or 0.0,
    )


def open_ways(
    document: SceneDocument, scene: scene_pb2.CompiledScene, film: Film, *, photons_can_start: bool
) -> tuple[list[str], Ways]:
    """What a pilot is to choose, of `nocturne-trace --pilot`, and the ways to compile its scene for.

    `photons_can_start`: at all luminaires.
    """
    tracing, given = document.tracing, given_ways(document)
    chosen = []
    may_forward = tracing.direction == "auto" and photons_can_start
    with_forward = _forward(document, scene, film) if may_forward else None
    if with_forward is not None:
        chosen.append("direction")
        aimed = tracing.aimed_emission or 0.0
        if tracing.aimed_emission is None and scene.important_shapes:
            chosen.append("aim")
            aimed = _AIMED
        given = Ways(with_forward, given.sharing, aimed)
    if tracing.sharing == "auto" and tracing.estimator == "two_photons" and given.direction != "forward":
        chosen.append("sharing")
    return chosen, given


def _forward(document: SceneDocument, scene: scene_pb2.CompiledScene, film: Film) -> str | None:
    """How photons from luminaires could take part; None: not at all."""
    kind = document.sensor.type
    direction = "both" if kind in CAMERAS else "forward" if kind in MET_BY_PHOTONS else None
    if direction is None:
        return None
    traced_so = scene_pb2.CompiledScene(sensor=scene.sensor, tracing=scene.tracing)
    traced_so.tracing.direction = DIRECTIONS[direction]
    try:
        schedule_of(traced_so, film.width, film.height, film.samples)
    except InputError:
        return None
    return direction


def choose(
    scene: scene_pb2.CompiledScene, blobs: Path, film: Film, chosen: list[str], asked: Ways
) -> tuple[Ways, str]:
    """The better ones of `chosen`, and how that was found, in a sentence. `scene` is compiled for `asked`.

    Without nocturne-trace, or where it fails, nothing is chosen, and the sentence says so.
    """
    default = Ways(
        "adjoint" if "direction" in chosen else asked.direction,
        1 if "sharing" in chosen else asked.sharing,
        0.0 if "direction" in chosen else asked.aimed_emission,
    )
    program = find_program("nocturne-trace")
    if program is None:
        return default, f"{default.named()}: nothing was compared, as nocturne-trace is missing here"
    try:
        found = _run(program, scene, blobs, film, chosen)
    except (OSError, subprocess.SubprocessError, ValueError):
        return default, f"{default.named()}: nothing was compared, as the pilot failed"
    ways = Ways(
        asked.direction if found["forward_photons"] else default.direction,
        int(found["sharing"]) if "sharing" in chosen else asked.sharing,
        asked.aimed_emission if found["aimed"] else 0.0,
    )
    return ways, _sentence(ways, default, found)


def _run(
    program: Path, scene: scene_pb2.CompiledScene, blobs: Path, film: Film, chosen: list[str]
) -> dict[str, Any]:
    words = ["--pilot", ",".join(chosen)]
    found: dict[str, Any] = json.loads(run_trace(program, scene, blobs, film, words, MAX_SECONDS))
    return found


def _sentence(ways: Ways, default: Ways, found: dict[str, Any]) -> str:
    tried = f"by a pilot of {found['photons']:,} photons"
    if ways == default:
        return f"{ways.named()}: no other way was found better {tried}"
    if found["finds_more"]:
        return f"{ways.named()}: {default.named()} missed light that these found, {tried}"
    gain = found["gain"]
    times = f"{gain:.0f}" if gain >= _EXACT_BELOW else f"{gain:.1f}"
    return f"{ways.named()}: {times} times less time to the same error than by {default.named()}, {tried}"
