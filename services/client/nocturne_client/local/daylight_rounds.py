"""Daylight coefficients of a scene's meters, by nocturne-trace on this machine, in rounds of samples."""

import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne.v1 import job_pb2, scene_pb2
from nocturne_scene.compile.daylight_coefficients import (
    frame_of,
    in_scene,
    points_of,
    see_as_melanopsin,
    sky_alone,
    sunny_environment,
    sunny_sky,
)
from nocturne_scene.daylight.coefficients import Coefficients, Layout
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight.points import Points
from nocturne_scene.daylight.year_of_skies import YearOfSkies
from nocturne_scene.daylight_ranges import daylight_range_ends
from nocturne_scene.document.changes import changed
from nocturne_scene.document.read import check_document
from nocturne_scene.document.sensors import Meters
from nocturne_scene.errors import InputError
from nocturne_scene.spectra.published import Floats
from numpy.typing import NDArray

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import compile_parts
from nocturne_client.local.failures import client_errors
from nocturne_client.local.programs import need_program
from nocturne_client.scene_files import SceneOnDisk, digest, read_scene

_LARGEST_FILM = 16384
_MOST_BYTES = 4e9


@dataclass(frozen=True)
class DaylightScene:
    """A scene whose only light is the sky."""

    on_disk: SceneOnDisk
    points: Points
    up: Floats
    north: Floats

    def in_scene(self, towards: Floats) -> Floats:
        """Directions of vectors to the east, to the north and up."""
        return in_scene(towards, self.up, self.north)


def daylight_scene(path: Path, changes: Mapping[str, Any], north: Floats | None) -> DaylightScene:
    """Reads a scene and leaves out all that is no daylight: lamps, its own sky, colours of its meters.

    `north`: instead of that of the document's sky. Raises NocturneClientError.
    """
    on_disk = read_scene(path)
    with client_errors(f"{path} can't be traced"):
        given = changed(on_disk.document, changes)
        document = check_document(given)
        if not isinstance(document.sensor, Meters):
            raise NocturneClientError(
                f"{path}: the sensor is {document.sensor.type}; daylight of a year is that of meters: "
                '"sensor": {"type": "meters", "instruments": [{"name": ..., "grid": ...}]}'
            )
        try:
            up, level = frame_of(document, north)
            points = points_of(document.sensor)
        except InputError as error:
            raise NocturneClientError(error.problems[0].message) from error
        alone = SceneOnDisk(sky_alone(given), on_disk.files)
    return DaylightScene(alone, points, up, level)


@dataclass(frozen=True)
class Rounds:
    """How coefficients are sampled."""

    batches: int
    samples: int
    """At most, of each batch."""
    threads: int
    seed: int | None
    melanopic: bool = False
    """Measure melanopic equivalent daylight illuminance instead of illuminance, all daylight being D65."""


def rounds(
    scene: DaylightScene,
    layout: Layout,
    skies: YearOfSkies,
    asked: Rounds,
    told: Callable[[str], None] = lambda _: None,
) -> Iterator[Coefficients]:
    """Coefficients of more and more samples. Each batch is a separate film, with other random numbers.

    Raises NocturneClientError.
    """
    check_size(scene.points, layout, skies, asked)
    with tempfile.TemporaryDirectory(prefix="nocturne-annual-") as name:
        folder = Path(name)
        suns, sunny = skies.sun_towards[skies.sunny], layout.sunny(skies)
        scene.in_scene(suns).astype("<f8").tofile(folder / "suns")
        of_sky = Traced(scene, scene.on_disk, folder / "sky", layout.sky, asked, told)
        with_suns = sunny_scene(scene, folder, layout.suns, sunny)
        of_suns = Traced(scene, with_suns, folder / "sun", layout.suns, asked, told) if len(sunny) else None
        total, first = None, 0
        for end in daylight_range_ends(asked.samples):
            straight = folder / "suns" if first == 0 and len(suns) else None
            sky, found, across = of_sky.trace(first, end, straight, len(suns) if straight else 0)
            reflected = np.zeros((*sky.shape[:2], 0))
            if of_suns is not None:
                reflected = of_suns.trace(first, end)[0][:, :, 1, sunny]
            more = Coefficients(sky.sum(axis=2), reflected, found, across, end - first)
            total = more if total is None else total + more
            yield total
            first = end


def check_size(points: Points, layout: Layout, skies: YearOfSkies, asked: Rounds) -> None:
    """Raises NocturneClientError where coefficients would not fit."""
    width, height = points.film
    pixels = width * height * asked.batches
    if max(width, height * asked.batches) > _LARGEST_FILM:
        raise NocturneClientError(f"{width} x {height} points in {asked.batches} batches are too many")
    values = 2 * max(layout.sky.count, layout.suns.count) + len(skies.sunny)
    if 8.0 * pixels * values > _MOST_BYTES:
        raise NocturneClientError(
            f"{pixels} points and batches times {values} patches and suns need more than 4 GB; expected "
            "fewer points, or --patches 145"
        )


def sunny_scene(scene: DaylightScene, folder: Path, patches: Patches, sunny: NDArray[np.intp]) -> SceneOnDisk:
    """The scene with a sky of 1 cd/m2 in some patches alone."""
    picture = folder / "suns.exr"
    sunny_sky(picture, patches, sunny)
    sha256 = digest(picture)
    document = {**scene.on_disk.document, "environment": sunny_environment(sha256, scene.up, scene.north)}
    return SceneOnDisk(document, {**scene.on_disk.files, sha256: picture})


class Traced:
    """A compiled scene, of whose patches coefficients are traced."""

    def __init__(
        self,
        scene: DaylightScene,
        on_disk: SceneOnDisk,
        folder: Path,
        patches: Patches,
        asked: Rounds,
        told: Callable[[str], None],
    ) -> None:
        self._scene, self._patches, self._asked, self._folder = scene, patches, asked, folder
        seed = {} if asked.seed is None else {"tracing.seed": asked.seed}
        film, samples = scene.points.film, asked.batches * asked.samples
        self._compiled = compile_parts(on_disk, folder, film, samples, seed, "the scene")
        if asked.melanopic:
            message = scene_pb2.CompiledScene.FromString(self._compiled.scene.read_bytes())
            see_as_melanopsin(message.sensor)
            self._compiled.scene.write_bytes(message.SerializeToString(deterministic=True))
        for line in self._compiled.said():
            told(line)

    def trace(
        self, first: int, end: int, suns: Path | None = None, count: int = 0
    ) -> tuple[Floats, Floats, Floats]:
        """Sums of samples by batch and point: by path, straight or not, and patches; by sun; across suns."""
        asked, (width, height) = self._asked, self._scene.points.film
        schedule = job_pb2.RangeSchedule(
            width=width, height=height * asked.batches, tile_size=16, range_ends=[end]
        )
        self._compiled.schedule.write_bytes(schedule.SerializeToString())
        sums = self._folder / "sums"
        command = [str(need_program("nocturne-trace")), str(self._compiled.scene)]
        command += ["--schedule", str(self._compiled.schedule), "--blobs", str(self._compiled.blobs)]
        command += ["-o", str(sums), "--threads", str(asked.threads), "--quiet"]
        command += ["--daylight", str(self._patches.divisions), "--first-sample", str(first)]
        command += ["--up", _joined(self._scene.up), "--north", _joined(self._scene.north)]
        _run([*command, *(["--suns", str(suns)] if suns else [])])
        of_batch = width * height
        pixels, of_one = asked.batches * of_batch, 2 * self._patches.count
        numbers = np.fromfile(sums, dtype="<f8")
        parts = np.split(numbers, [pixels * of_one, pixels * (of_one + count)])
        sky, of_suns, across = (
            part.reshape(asked.batches, of_batch, -1)[:, self._scene.points.pixels] for part in parts
        )
        return sky.reshape(*sky.shape[:2], 2, -1), of_suns, across[..., 0]


def _joined(vector: Floats) -> str:
    return ",".join(f"{each:.9g}" for each in vector)


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)  # noqa: S603
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no word"])[-1]
        raise NocturneClientError(f"nocturne-trace failed ({done.returncode}): {last}")
