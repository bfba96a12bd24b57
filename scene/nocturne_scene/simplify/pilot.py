"""Small renders of models of a scene on this machine: the effects and savings of simplifications."""

import json
import subprocess
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.blobs import BlobStore
from nocturne_scene.compare.images import read_picture
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import PilotFailed
from nocturne_scene.programs import find_program
from nocturne_scene.scene_ranges import schedule_of
from nocturne_scene.simplify.choosing import Model
from nocturne_scene.simplify.simplification import Document, Simplification
from nocturne_scene.simplify.statistics import (
    Values,
    bias,
    effective_pixels,
    noise,
    ratio_of_costs,
)

Parts = tuple[Simplification, ...]

RENDERS = 8
"""Of each model, with independent seeds."""

# Seeds are the same in each preflight, and none is used twice in one.
_SEEDS_FROM = 20


@dataclass(frozen=True)
class Shot:
    """One small render."""

    y: Values
    """Luminance, shape (height, width)."""
    cpu_s: float
    """Of tracing alone."""


class Pilot:
    """Renders models of one scene, all on the same small film."""

    def __init__(self, document: Document, folder: Path, film: tuple[int, int], threads: int) -> None:
        """`folder` is for files in between, and holds those of the scene in `blobs`; `film` is width and
        height in pixels. Raises PilotFailed where there is no nocturne-trace."""
        program = find_program("nocturne-trace")
        if program is None:
            raise PilotFailed(
                "nocturne-trace is missing: build it, or say where it is with NOCTURNE_BIN=FOLDER"
            )
        self._program = program
        self._document = document
        self._folder, self._film, self._threads = folder, film, threads
        self._blobs = BlobStore(folder / "blobs", durable=False)
        self._compiled: dict[tuple[str, ...], scene_pb2.CompiledScene] = {}
        self._seeds = _seeds()
        self.cpu_s = 0.0
        """Processor time of all renders so far."""

    @property
    def pixels(self) -> int:
        return self._film[0] * self._film[1]

    def find(self, asset: str) -> Path:
        """The file of an asset reference."""
        return self._blobs.path(asset.removeprefix("sha256:"))

    def document(self, parts: Parts) -> Document:
        """The scene without some parts."""
        document = self._document
        for part in parts:
            document = part.applied(document)
        return document

    def compiled(self, parts: Parts) -> scene_pb2.CompiledScene:
        """The same compiled, once. Raises InputError."""
        key = tuple(part.name for part in parts)
        if key not in self._compiled:
            output = compile_scene(check_document(self.document(parts)), self._blobs)
            data = self._blobs.path(output.scene_sha256).read_bytes()
            self._compiled[key] = scene_pb2.CompiledScene.FromString(data)
        return self._compiled[key]

    def shoot(self, parts: Parts, samples: int, seed: int) -> Shot:
        """One render. Raises InputError, and PilotFailed if the tracer fails."""
        scene = scene_pb2.CompiledScene()
        scene.CopyFrom(self.compiled(parts))
        scene.tracing.seed = seed
        files = {
            name: self._folder / name for name in ("scene.pb", "schedule.pb", "image.exr", "statistics.json")
        }
        files["scene.pb"].write_bytes(scene.SerializeToString(deterministic=True))
        schedule = schedule_of(scene, *self._film, samples)
        files["schedule.pb"].write_bytes(schedule.SerializeToString(deterministic=True))
        words: list[str | Path] = [
            self._program,
            files["scene.pb"],
            "--schedule",
            files["schedule.pb"],
            "--blobs",
            self._folder / "blobs",
        ]
        words += ["-o", files["image.exr"], "--statistics", files["statistics.json"]]
        words += ["--threads", str(self._threads), "--quiet"]
        done = subprocess.run(  # noqa: S603 - our own program
            words, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", check=False
        )
        if done.returncode != 0:
            raise PilotFailed(f"nocturne-trace failed ({done.returncode}): {done.stderr.strip()}")
        picture = read_picture(files["image.exr"])
        cpu_s = float(json.loads(files["statistics.json"].read_text())["cpu_seconds"])
        self.cpu_s += cpu_s
        return Shot(picture.xyz[..., 1], cpu_s)

    def measure(
        self, models: Sequence[Parts], samples: int, confidence: float, step: Callable[[], None]
    ) -> tuple[Model, list[Model], float]:
        """The full model and others in turn, RENDERS times with new seeds; `step` is called after each.

        Returns the full model, the others, and how many pixels carry the full one's noise.
        """
        all_models: list[Parts] = [(), *models]
        shots: list[list[Shot]] = [[] for _ in all_models]
        for _ in range(RENDERS):
            seed = next(self._seeds)
            for parts, taken in zip(all_models, shots, strict=True):
                taken.append(self.shoot(parts, samples, seed))
                step()
        if not any(shot.y.any() for shot in shots[0]):
            raise PilotFailed("the pilot's image is black, so there is nothing to compare with")
        images = [np.stack([shot.y.ravel() for shot in taken]) for taken in shots]
        # A clock's tick, so that nothing is divided by zero.
        costs = [np.array([max(shot.cpu_s, 1e-6) for shot in taken]) for taken in shots]
        measured = [
            Model(
                parts,
                bias(images[0], image, confidence),
                noise(images[0], image) * samples,
                float(cost.mean()) / samples / self.pixels,
                ratio_of_costs(costs[0], cost, confidence),
            )
            for parts, image, cost in zip(all_models, images, costs, strict=True)
        ]
        return measured[0], measured[1:], effective_pixels(images[0])


def _seeds() -> Iterator[int]:
    random = np.random.default_rng(_SEEDS_FROM)
    while True:
        yield int(random.integers(2**63))
