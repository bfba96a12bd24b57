"""Mitsuba's test scenes: imported, rendered in independent batches, and their references."""

import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.programs import need_program
from nocturne_scene.compare.agreement import Estimate
from nocturne_scene.compare.images import read_picture
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT
from nocturne_scene.formats.reading.options import Imported, ImportOptions
from numpy.typing import NDArray

FOLDER = Path(__file__).parents[3] / "shared" / "mitsuba_tests"
SCENES = FOLDER / "tests" / "scenes"

REFERENCE_SAMPLES = 32_000
"""Of a pixel of a reference: the default of the script that renders them."""

FLOOR = 1e-4
"""Of the variance of one sample, in Mitsuba's rule."""


def import_test(name: str, folder: Path) -> Imported:
    """Import SCENES/name.xml, such as "bsdf_spheres/test_constant_path"."""
    return import_scene(SCENES / f"{name}.xml", folder, ImportOptions(root=FOLDER))


@dataclass(frozen=True)
class Reference:
    """A published image."""

    estimate: Estimate
    one_sample: Estimate
    """The same with the variance of one sample, which shows light that is too rare for few samples."""

    @classmethod
    def of(cls, name: str) -> "Reference":
        scene = SCENES / name
        stem = scene.parent / "refs" / scene.name.rpartition("_")[0]
        mean, variance = (read_picture(Path(f"{stem}_ref_spectral{end}.exr")).xyz for end in ("", "_var"))
        variance = np.maximum(variance, 0.0)
        return cls(Estimate(mean, variance / REFERENCE_SAMPLES), Estimate(mean, variance))

    def guard(self, image: Estimate, samples: int) -> Estimate:
        """An image of so many samples with no less variance than Mitsuba's rule gives its own.

        Where a rare event was missed by all samples of a pixel, their scatter is too small.
        """
        assert image.variance is not None
        assert self.one_sample.variance is not None
        return Estimate(
            image.mean,
            np.maximum(image.variance, np.maximum(self.one_sample.variance, FLOOR) / samples),
            image.degrees,
        )


@dataclass(frozen=True)
class Batches:
    """Renders with separate seeds."""

    scene: Imported
    folder: Path
    count: int
    samples: int
    """Of each pixel in each batch."""

    def render(self) -> Estimate:
        """The mean of all batches in Mitsuba's unit, its variance from their scatter."""
        stack = np.stack(list(self._frames()))
        return Estimate(stack.mean(axis=0), stack.var(axis=0, ddof=1) / self.count, self.count - 1)

    def means(self) -> NDArray[np.float64]:
        """X, Y, Z of each batch's whole image, shape (batches, 3)."""
        return np.stack([frame.mean(axis=(0, 1)) for frame in self._frames()])

    def _frames(self) -> Iterator[NDArray[np.float64]]:
        film = self.scene.film
        compiled = compile_to(self.scene.document, self.folder, film.width, film.height, self.samples)
        message = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes())
        for seed in range(1, self.count + 1):
            message.tracing.seed = seed
            compiled.scene.write_bytes(message.SerializeToString(deterministic=True))
            image = self.folder / "batch.exr"
            command: list[str | Path] = [need_program("nocturne-trace"), compiled.scene, "-o", image]
            subprocess.run(
                [*command, "--quiet", "--schedule", compiled.schedule, "--blobs", compiled.blobs], check=True
            )
            yield read_picture(image).xyz / CANDELAS_PER_UNIT
