"""Measures single numbers: what a meter reads, with a standard error that is honest for Sobol points too.

The standard error of Sobol points that an image carries is too large, which hides faults. Here it comes from
the scatter of repeated measurements: pixels of a film that all measure the same, or runs with other seeds.
Their scrambling is independent, so the mean of n is compared by Student's t with n - 1 degrees of freedom.

Wavelengths are drawn uniformly and the response is 1 at all of them, so that a grey scene has no noise from
wavelengths: readings are per nanometre, mean values over 360 to 830 nm.
"""

import json
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_scene.compile.compiler import FORMAT_WITH_GUIDE
from nocturne_scene.scene_ranges import schedule_of
from nocturne_scene.validation.documents import GREY, RANGE_NM

from tests.accuracy.agreement import ROUNDING, Values, student_bound
from tests.accuracy.tracing import Document, part_of, run, run_seeds
from tests.system.images import Image


@dataclass(frozen=True)
class Reading:
    """The mean of independent measurements of the same."""

    mean: float
    error: float
    """Standard error of the mean."""
    count: int
    """Measurements."""

    @classmethod
    def of(cls, values: Values) -> "Reading":
        mean, count = float(values.mean()), values.size
        return cls(mean, float(values.std(ddof=1)) / count**0.5, count)

    def bound(self, values: int = 1) -> float:
        """Largest deviation that chance alone explains, in standard errors.

        False alarms: 0.01 for all `values` that a test looks at (Sidak).
        """
        return student_bound(values, self.count - 1)

    def check(self, truth: float, uncertainty: float = ROUNDING, values: int = 1) -> None:
        """Fails unless the truth is near; `uncertainty` is the allowed part of it, beyond chance."""
        allowed = self.bound(values) * self.error + uncertainty * abs(truth)
        assert abs(self.mean - truth) <= allowed, (
            f"read {self.mean:.8g} +- {self.error:.2g}, truth {truth:.8g}, z {self.z(truth):.2f}, "
            f"off by a part of {self.mean / truth - 1.0 if truth else np.inf:.2g}"
        )

    def z(self, truth: float) -> float:
        if self.mean == truth:
            return 0.0
        return (self.mean - truth) / self.error if self.error else float("inf")

    def __mul__(self, factor: float) -> "Reading":
        return Reading(self.mean * factor, self.error * abs(factor), self.count)

    def __sub__(self, known: float) -> "Reading":
        return Reading(self.mean - known, self.error, self.count)


def check_equal(one: Reading, other: Reading, uncertainty: float = ROUNDING, values: int = 1) -> None:
    """Fails unless two readings of the same agree; degrees of freedom of the one with fewer measurements."""
    error = float(np.hypot(one.error, other.error))
    fewest = Reading(0.0, error, min(one.count, other.count))
    allowed = fewest.bound(values) * error + uncertainty * abs(one.mean)
    assert abs(one.mean - other.mean) <= allowed, (one, other, (one.mean - other.mean) / error)


class Measurement:
    """A scene, compiled once; its meter can then be moved and its random numbers changed."""

    def __init__(self, document: Document, folder: Path, width: int = 1, height: int = 1) -> None:
        self.statistics: dict[str, Any] = {}
        """Of the last image."""
        self._folder = folder
        self._document = document
        self._size = width, height
        self._compiled = self._compile(document, folder / "scene")
        self._scene = scene_pb2.CompiledScene.FromString(self._compiled.scene.read_bytes())

    def move(self, **sensor: Any) -> None:
        """Another sensor in the same scene."""
        document = deepcopy(self._document)
        # What lights the scene stays as it is; without a map this is quick.
        document["environment"] = {"radiance": 1.0}
        document["sensor"] = {**GREY, **sensor}
        document["surfaces"] = document["surfaces"][:1]
        moved = self._compile(document, self._folder / "moved")
        other = scene_pb2.CompiledScene.FromString(moved.scene.read_bytes())
        self._scene.sensor.CopyFrom(other.sensor)

    def see(self, visible_sky: bytes) -> None:
        """Has photons know which sky is visible, as CompiledScene.visible_sky says."""
        self._scene.visible_sky = visible_sky

    def guide(self, learned_light: bytes) -> None:
        """Photons from the sensor go where this says that light comes from, too; as in CompiledScene."""
        self._scene.learned_light = learned_light
        self._scene.format = FORMAT_WITH_GUIDE

    def by_pixels(self, samples: int, channel: str = "grey", seed: int = 0) -> Reading:
        """For a film whose pixels all measure the same."""
        return Reading.of(_values(self.image(part_of(samples), seed), channel))

    def by_seeds(self, samples: int, seeds: int = 8, channel: str = "grey") -> Reading:
        """The mean over a film; for films whose pixels differ."""
        found = run_seeds(self._planned(part_of(samples), 0), self._folder, seeds)
        self.statistics = found[-1][1]
        return Reading.of(np.array([_values(image, channel).mean() for image, _ in found]))

    def image(self, samples: int, seed: int = 0) -> Image:
        image, self.statistics = run(self._planned(samples, seed), self._folder)
        return image

    def _planned(self, samples: int, seed: int) -> CompiledFolder:
        """The scene as it is now and its schedule, in files."""
        self._scene.tracing.seed = seed
        plan = schedule_of(self._scene, *self._size, samples)
        used = replace(self._compiled, scene=self._folder / "scene.pb", schedule=self._folder / "schedule.pb")
        used.scene.write_bytes(self._scene.SerializeToString(deterministic=True))
        used.schedule.write_bytes(plan.SerializeToString(deterministic=True))
        return used

    def _compile(self, document: Document, folder: Path) -> CompiledFolder:
        folder.mkdir(exist_ok=True)
        path = self._folder / "scene.json"
        path.write_text(json.dumps(document))
        return compile_to(path, folder, *self._size, 1)


def image_by(
    direction: str, document: Document, pixels: tuple[int, int], samples: int, seed: int, folder: Path
) -> Image:
    """By photons of a direction and independent numbers; none may be invalid_samples. Makes the folder."""
    folder.mkdir()
    tracing = {**document.get("tracing", {}), "sequence": "independent", "direction": direction}
    measurement = Measurement({**document, "tracing": tracing}, folder, *pixels)
    image = measurement.image(samples, seed)
    assert measurement.statistics["invalid_samples"] == 0
    return image


def _values(image: Image, channel: str) -> Values:
    if channel == "Y":
        return image.y
    return image.further[channel].astype(np.float64) / RANGE_NM


def independent_image(
    document: Document,
    seed: int,
    folder: Path,
    prepare: Callable[[Measurement], None] | None = None,
    **tracing: Any,
) -> Image:
    """Of 16 x 16 pixels, by independent numbers; `folder` is made, `prepare` changes the compiled scene."""
    folder.mkdir()
    traced = {**document, "tracing": {"sequence": "independent", **tracing}}
    measurement = Measurement(traced, folder, 16, 16)
    if prepare is not None:
        prepare(measurement)
    image = measurement.image(part_of(1024), seed)
    assert measurement.statistics["invalid_samples"] == 0
    return image
