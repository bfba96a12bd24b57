"""Daylight coefficients of a scene's meters, by nocturne-trace on this machine, in rounds of samples."""

import copy
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from nocturne.v1 import job_pb2, scene_pb2
from nocturne_scene.compile.meters import places_of
from nocturne_scene.compile.spectra import response
from nocturne_scene.daylight.coefficients import Coefficients, Layout
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight.year_of_skies import YearOfSkies
from nocturne_scene.document.changes import changed
from nocturne_scene.document.instruments import Instrument
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.read import check_document
from nocturne_scene.document.sensors import Meters
from nocturne_scene.document.skies import StandardSky, WeatherSky
from nocturne_scene.spectra import published
from nocturne_scene.spectra.published import Floats
from numpy.typing import NDArray

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import compile_parts
from nocturne_client.local.failures import client_errors
from nocturne_client.local.programs import need_program
from nocturne_client.scene_files import DIGEST_PREFIX, SceneOnDisk, digest, read_scene

_WHITE = {"radiance": {"illuminant": "D65", "luminance": 1.0}}
"""1 cd/m2 from everywhere."""
_RESPONSES = ("responses", "named_responses", "bands", "colour", "light_parts", "measures", "observer")
_PICTURE = (1024, 2048)
"""Rows and columns of a picture of the Sun's patches."""
_LARGEST_FILM = 16384
_MOST_BYTES = 4e9


@dataclass(frozen=True)
class Points:
    """Where daylight is measured."""

    instruments: list[Instrument]
    names: list[str]
    """Of the instrument, by point."""
    places: Floats
    """By point, m."""
    film: tuple[int, int]
    """Columns and rows of one batch."""
    pixels: list[int]
    """On that film, by point."""


@dataclass(frozen=True)
class DaylightScene:
    """A scene whose only light is the sky."""

    on_disk: SceneOnDisk
    points: Points
    up: Floats
    north: Floats

    def in_scene(self, towards: Floats) -> Floats:
        """Directions of vectors to the east, to the north and up."""
        return towards @ np.stack([np.cross(self.north, self.up), self.north, self.up])


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
        up, found_north = _frame(document)
        if north is not None:
            found_north = north
        up = up / np.linalg.norm(up)
        level = found_north - (found_north @ up) * up
        if np.linalg.norm(level) < 1e-6 * np.linalg.norm(found_north) or not found_north.any():
            raise NocturneClientError("north is straight up or down; expected a direction on the level")
        alone = SceneOnDisk(_sky_alone(given), on_disk.files)
        points = _points(document.sensor)
    return DaylightScene(alone, points, up, level / np.linalg.norm(level))


def _frame(document: SceneDocument) -> tuple[Floats, Floats]:
    sky = document.environment
    north = np.array([0.0, 0.0, -1.0])
    if not isinstance(sky, StandardSky | WeatherSky):
        return np.array([0.0, 1.0, 0.0]), north
    return np.array(sky.up), north if sky.place is None else np.array(sky.place.north)


def _sky_alone(document: Mapping[str, Any]) -> dict[str, Any]:
    made = copy.deepcopy(dict(document))
    waiting: list[Any] = [made.get("surfaces", []), made.get("groups", {})]
    while waiting:
        part = waiting.pop()
        if isinstance(part, dict):
            part.pop("luminaire", None)
            waiting += part.values()
        elif isinstance(part, list):
            waiting += part
    for name in ("distant", "ray_files"):
        made.pop(name, None)
    made["environment"] = _WHITE
    made["sensor"] = {name: value for name, value in made["sensor"].items() if name not in _RESPONSES}
    tracing = {**made.get("tracing", {}), "direction": "adjoint", "sharing": 1}
    made["tracing"] = {
        name: value for name, value in tracing.items() if not name.startswith(("aim", "forward"))
    }
    return made


def _points(sensor: Meters) -> Points:
    (width, height), corners = sensor.layout()
    names, places, pixels, kept = [], [], [], []
    for instrument, (left, top) in zip(sensor.instruments, corners, strict=True):
        if instrument.name == sensor.outdoor:
            continue
        if instrument.faces is not None:
            raise NocturneClientError(
                f'the instrument "{instrument.name}" is on faces; daylight of a year is of points and grids'
            )
        kept.append(instrument)
        columns = instrument.size[0]
        for index, place in enumerate(places_of(instrument)):
            names.append(instrument.name)
            places.append(place)
            pixels.append((top + index // columns) * width + left + index % columns)
    return Points(kept, names, np.array(places, dtype=np.float64), (width, height), pixels)


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
        for end in _ends(asked.samples):
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
    rows, columns = _PICTURE
    polar = np.pi * (np.arange(rows) + 0.5) / rows
    # The picture's middle is north, its right half the east.
    azimuth = 2 * np.pi * (np.arange(columns) + 0.5) / columns - np.pi
    across = np.sin(polar)[:, None]
    towards = np.stack(
        np.broadcast_arrays(across * np.sin(azimuth), across * np.cos(azimuth), np.cos(polar)[:, None]),
        axis=-1,
    )
    lit = np.isin(patches.numbers(towards), sunny)
    # Patches are lit up to their edges, where texels are means.
    for axis in (0, 1):
        lit |= np.roll(lit, 1, axis) | np.roll(lit, -1, axis)
    plane = lit.astype(np.float32)
    picture = folder / "suns.exr"
    with OpenEXR.File({}, {"RGB": np.stack([plane] * 3, axis=-1)}) as file:
        file.write(str(picture))
    sha256 = digest(picture)
    sky = {
        "asset": DIGEST_PREFIX + sha256,
        "luminance": 1.0,
        "up": scene.up.tolist(),
        "forward": scene.north.tolist(),
    }
    document = {**scene.on_disk.document, "environment": sky}
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
            _see_as_melanopsin(self._compiled.scene)
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


def _see_as_melanopsin(scene: Path) -> None:
    """Changes the responses of a compiled scene: daylight of 1 lx and D65 reads 1 (CIE S 026/E:2018)."""
    message = scene_pb2.CompiledScene.FromString(scene.read_bytes())
    wavelengths = published.visible_wavelengths()
    action = published.alpha_opic_spectra()[:, published.ALPHA_OPIC.index("melanopic")]
    curve = np.interp(wavelengths, published.colour_wavelengths(), action, left=0.0, right=0.0)
    daylight = np.interp(wavelengths, *published.illuminant("D65"))
    seen = response()[:, 1]
    curve = curve * (seen @ daylight) / (curve @ daylight)
    for of_sensor in (message.sensor.response_x, message.sensor.response_y, message.sensor.response_z):
        of_sensor[:] = curve.tolist()
    scene.write_bytes(message.SerializeToString(deterministic=True))


def _ends(samples: int) -> Iterator[int]:
    """Suns have a sample of each batch; then the number doubles."""
    yield 1
    end = 32
    while end < samples:
        yield end
        end *= 2
    if samples > 1:
        yield samples


def _joined(vector: Floats) -> str:
    return ",".join(f"{each:.9g}" for each in vector)


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)  # noqa: S603
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no word"])[-1]
        raise NocturneClientError(f"nocturne-trace failed ({done.returncode}): {last}")
