"""How a scene is traced: methods that share little code, each by several seeds in one process."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import numpy.typing as npt
from nocturne.v1 import scene_pb2
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_scene.compare.images import read_picture
from nocturne_scene.compile.ways import WORTH_A_PILOT
from nocturne_scene.document.checks import CAMERAS, MET_BY_PHOTONS
from nocturne_scene.scene_ranges import schedule_of
from nocturne_scene.uncertainty import ImageMoments, read_region

from tests.accuracy.tracing import Document, write
from tests.crossings.chance import Chance
from tests.crossings.program import Failed, program
from tests.crossings.scenes import Scene

Values = npt.NDArray[np.float64]

PLAIN = "plain"
CHOSEN = "chosen"
"""The method that a pilot chooses for a long render whose document leaves it open."""
_PLAIN = {"sequence": "independent", "sharing": 1, "guide": "none", "direction": "adjoint"}

_TRAPPED = 1e-5
"""Part of the photons that may be ended by the limit of interactions: clear glass with interpolated normals
lets light in that is trapped by total reflection."""
_FORWARD = 16
"""Samples of a film by photons from luminaires, most of which miss it, for each by photons from it."""


class Refused(Exception):
    """The compiler does not take this method for this scene."""


@dataclass(frozen=True)
class Readings:
    """What images by several seeds say of regions: the whole, and its quarters."""

    names: tuple[str, ...]
    """X, Y, Z and further responses."""
    means: Values
    """Shape (seeds, regions, names)."""
    errors: Values
    """As the images state them, same shape."""
    factors: Values
    """Errors to each side of a 95 % interval of Y, shape (seeds, regions)."""
    cpu_s: float


def methods_of(scene: Scene) -> dict[str, Document]:
    """Documents by the method's name, the plain one first; some may be refused."""
    chance = Chance(scene.seed + 10**9)
    found = {
        PLAIN: dict(_PLAIN),
        "shared": {"sharing": 16, "direction": "adjoint"},
        "mixture": _PLAIN | {"estimator": "mixture"} | _mixture(chance, wide=scene.wide),
        "varied": _varied(chance, wide=scene.wide, dark='"absorption"' in json.dumps(scene.document)),
    }
    found[CHOSEN] = {"direction": "auto", "sharing": "auto", "guide": "auto"}
    kind = scene.document["sensor"]["type"]
    # A meter counts all photons from luminaires that leave the scene, also those of objects outside.
    if kind in (*CAMERAS, *MET_BY_PHOTONS) and scene.alone:
        found["other"] = _other(chance, scene.document, "both" if kind in CAMERAS else "forward")
    kept = scene.document.get("tracing", {})
    return {name: scene.document | {"tracing": {**kept, **ways}} for name, ways in found.items()}


def _mixture(chance: Chance, *, wide: bool) -> Document:
    """The kernel always has a weight: without it light of other surfaces is lost. Lamps have one where they
    are small: by chance they would be met once in a million photons."""
    if chance.maybe(0.4):
        return {}
    weights = {"kernel": chance.number(0.3, 1.0)}
    for name in ("luminaires", "environment", "important", "uniform"):
        if chance.maybe(0.6) or (not wide and name in ("luminaires", "environment")):
            weights[name] = chance.number(0.1, 0.6)
    return {"mixture": weights}


def _varied(chance: Chance, *, wide: bool, dark: bool) -> Document:
    """Whatever else the language has to say about tracing. `dark`: glass or media absorb.

    Of light that metres of them absorb, roulette from the first vertex on leaves one photon in thousands
    (crossing 70086).
    """
    estimator = chance.pick(["split", "two_photons", "split"])
    made: Document = {"direction": "adjoint", "guide": "none", "estimator": estimator}
    made |= _mixture(chance, wide=wide)
    made["sequence"] = chance.pick(["sobol", "independent"])
    if estimator == "split":
        made["split_vertices"] = chance.whole(1, 2)
    else:
        made["sharing"] = chance.pick([1, 16, 16])
    made["photons_together"] = chance.pick([1, 4, "auto"])
    if chance.maybe(0.5):
        made["roulette"] = chance.pick(["albedo", "weight"])
        made["h"] = 1.0 if made["roulette"] == "albedo" else chance.number(0.5, 4.0)
    if chance.maybe(0.5):
        made["roulette_after"] = max(chance.whole(0, 3), 2 if dark else 0)
    return made


def _other(chance: Chance, document: Document, direction: str) -> Document:
    """Photons from luminaires."""
    # Guided photons are those of the chosen method; here they would ask a pilot each time.
    made: Document = {"direction": direction, "sequence": "independent", "guide": "none"}
    if direction == "both":
        made["sharing"] = chance.pick([1, 16])
        made["forward_ratio"] = chance.pick(["auto", 0.5, 2.0])
    through_media = {"media", "unbounded_media", "atmosphere"} & document.keys()
    if chance.maybe(0.5):
        # Refused of photons from luminaires through media.
        made["photons_together"] = chance.pick([1] if direction == "forward" and through_media else [1, 4])
    if chance.maybe(0.5):
        made["aimed_emission"] = chance.number(0.1, 0.7)
    return made


def compiled(document: Document, scene: Scene, folder: Path, samples: int) -> CompiledFolder:
    """Into a folder that has the files that scenes name. Raises Refused."""
    try:
        return compile_to(write(document, folder), folder, scene.width, scene.height, samples)
    except NocturneClientError as error:
        # Fluorescent scenes share nothing.
        if any("adjoint" in each.message or "can't share" in each.message for each in error.problems):
            raise Refused(str(error)) from error
        raise


def traced(
    document: Document, scene: Scene, folder: Path, samples: int, seeds: int, first: int = 1
) -> Readings:
    """By `seeds` seeds from `first`. Raises Refused and Failed."""
    made = _scheduled(document, scene, folder, samples)
    if first == 1:
        cpu_s = _run(made, folder, "{seed}.exr", "--seeds", str(seeds))
    else:
        cpu_s = sum(
            _run(_with_seed(made, folder, seed), folder, f"{seed - first + 1}.exr")
            for seed in range(first, first + seeds)
        )
    images = [read_picture(folder / f"{seed}.exr") for seed in range(1, seeds + 1)]
    read = [_regions(image.moments) for image in images if image.moments is not None]
    means, errors, factors = (np.array([each[part] for each in read]) for part in range(3))
    return Readings(images[0].names, means, errors, factors, cpu_s)


def _scheduled(document: Document, scene: Scene, folder: Path, samples: int) -> CompiledFolder:
    tracing = document["tracing"]
    if tracing.get("direction") == "adjoint":
        # A pilot has nothing to choose. It would only warn, which takes as long as the photons themselves.
        with patch("nocturne_scene.compile.ways.find_program", return_value=None):
            return compiled(document, scene, folder, samples)
    if tracing.get("direction") != "auto":
        forward = tracing.get("direction") == "forward"
        return compiled(document, scene, folder, samples * (_FORWARD if forward else 1))
    made = compiled(document, scene, folder, -(-WORTH_A_PILOT // (scene.width * scene.height)))
    message = scene_pb2.CompiledScene.FromString(made.scene.read_bytes())
    if message.tracing.direction == scene_pb2.DIRECTION_FORWARD:
        samples *= _FORWARD
    schedule = schedule_of(message, scene.width, scene.height, samples)
    made.schedule.write_bytes(schedule.SerializeToString(deterministic=True))
    return made


def _with_seed(made: CompiledFolder, folder: Path, seed: int) -> CompiledFolder:
    message = scene_pb2.CompiledScene.FromString(made.scene.read_bytes())
    message.tracing.seed = seed
    other = replace(made, scene=folder / "seed.pb")
    other.scene.write_bytes(message.SerializeToString(deterministic=True))
    return other


def _run(made: CompiledFolder, folder: Path, image: str, *options: str) -> float:
    """CPU seconds."""
    output = folder / image
    words: list[object] = [made.scene, "-o", output, "--schedule", made.schedule, "--blobs", made.blobs]
    words += ["--quiet", "--threads", 1, "--statistics", output.with_suffix(".json"), *options]
    program().run(words)
    statistics: list[Mapping[str, Any]] = [
        json.loads(path.read_text())
        for path in sorted(folder.glob(image.replace("{seed}", "*")[:-3] + "json"))
        if path.stem.isdigit()
    ]
    photons = sum(each["photons"] for each in statistics)
    for what, allowed in (("invalid_samples", 0.0), ("truncated_paths", _TRAPPED)):
        count = sum(each[what] for each in statistics)
        if count > allowed * photons:
            raise Failed(f"{count} {what}")
    return float(sum(each["cpu_seconds"] for each in statistics))


def quarters(height: int, width: int) -> list[npt.NDArray[np.bool_]]:
    """Which pixels are in each quarter of an image: above before below, left before right."""
    rows, columns = np.mgrid[0:height, 0:width]
    quarter = 2 * (rows >= height // 2) + (columns >= width // 2)
    return [quarter == which for which in range(4)]


def _regions(moments: ImageMoments) -> tuple[Values, Values, Values]:
    """Means, errors and interval factors of the whole and of its quarters."""
    readings = [read_region(moments, each) for each in (None, *quarters(*moments.samples.shape))]
    found = [each for each in readings if each is not None]
    return (
        np.array([each.mean for each in found]),
        np.array([each.error for each in found]),
        np.array([each.coverage_factor for each in found]),
    )
