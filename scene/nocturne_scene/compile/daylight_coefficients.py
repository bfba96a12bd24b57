"""Daylight coefficients of a scene's meters: which scene is traced for them, and what is counted there.

Of a sky of 1 cd/m2 from everywhere, of one that shines where the Sun is at some hour, and of the Sun's disc
itself, hour by hour; see nocturne_scene.daylight.coefficients.
"""

import copy
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.meters import places_of
from nocturne_scene.compile.spectra import response
from nocturne_scene.daylight import points as daylight_points
from nocturne_scene.daylight.coefficients import Layout
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight.points import Points
from nocturne_scene.daylight.weather_files import BadWeatherFileError, WeatherYear, read_epw
from nocturne_scene.daylight.year_of_skies import skies_of
from nocturne_scene.document.daylight import YearOfDaylight
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.read import check_document
from nocturne_scene.document.sensors import Meters
from nocturne_scene.document.shapes import DIGEST_PREFIX
from nocturne_scene.document.skies import StandardSky, WeatherSky
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film
from nocturne_scene.scene_ranges import coefficients_of
from nocturne_scene.spectra import published
from nocturne_scene.spectra.published import Floats

_WHITE = {"radiance": {"illuminant": "D65", "luminance": 1.0}}
"""1 cd/m2 from everywhere."""
_LEFT_OUT = (
    "responses",
    "named_responses",
    "bands",
    "colour",
    "light_parts",
    "measures",
    "observer",
    "daylight",
)
_PICTURE = (1024, 2048)
"""Rows and columns of a picture of the Sun's patches."""
_DIVISIONS = {145: 1, 577: 2, 2305: 4}
_WEATHER = "$.sensor.daylight.weather.asset"
_MOST_BYTES = 4e9
"""Of all coefficients of a render."""


def points_of(sensor: Meters) -> Points:
    """The points of a room: all but the meters outdoors. Raises InputError."""
    (width, height), corners = sensor.layout()
    names, places, pixels, kept = [], [], [], []
    for instrument, (left, top) in zip(sensor.instruments, corners, strict=True):
        if instrument.name == sensor.outdoor:
            continue
        if instrument.faces is not None:
            told = f'"{instrument.name}" is on faces; daylight of a year is of points and grids'
            raise InputError.at("$.sensor.instruments", told)
        columns, rows = instrument.size
        kept.append(daylight_points.Instrument(instrument.name, columns, rows, instrument.grid is not None))
        for index, place in enumerate(places_of(instrument)):
            names.append(instrument.name)
            places.append(place)
            pixels.append((top + index // columns) * width + left + index % columns)
    return Points(kept, names, np.array(places, dtype=np.float64), (width, height), pixels)


def frame_of(document: SceneDocument, north: Sequence[float] | Floats | None) -> tuple[Floats, Floats]:
    """Unit vectors up and to the north: `north`, or that of the document's sky, or -z. Raises InputError."""
    sky, up, found = document.environment, np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])
    if isinstance(sky, StandardSky | WeatherSky):
        up = np.array(sky.up)
        found = found if sky.place is None else np.array(sky.place.north)
    if north is not None:
        found = np.array(north)
    up = up / np.linalg.norm(up)
    level = found - (found @ up) * up
    if np.linalg.norm(level) < 1e-6 * np.linalg.norm(found) or not found.any():
        raise InputError.at(
            "$.sensor.daylight.north", "north is straight up or down; expected a direction on the level"
        )
    return up, level / np.linalg.norm(level)


def in_scene(towards: Floats, up: Floats, north: Floats) -> Floats:
    """Directions of vectors to the east, to the north and up."""
    return np.asarray(towards @ np.stack([np.cross(north, up), north, up]))


def layout_of(year: YearOfDaylight) -> Layout:
    """Which patches coefficients are of."""
    return Layout(Patches(_DIVISIONS[year.patches]), Patches(_DIVISIONS[year.sun_patches]))


def weather_of(year: YearOfDaylight, blobs: BlobStore) -> WeatherYear:
    """The weather file. Raises InputError, and NotFound where it was not uploaded."""
    reference = year.weather.asset
    if not reference.startswith(DIGEST_PREFIX):
        raise InputError.at(_WEATHER, f'expected "{DIGEST_PREFIX}" and the digest of an uploaded file')
    path = blobs.path(reference.removeprefix(DIGEST_PREFIX))
    try:
        return read_epw(path.read_text(encoding="utf-8", errors="replace"))
    except BadWeatherFileError as error:
        raise InputError.at(_WEATHER, str(error)) from None


def sky_alone(document: Mapping[str, Any]) -> dict[str, Any]:
    """The scene under an even sky: without lamps, its own sky, and colours of its meters."""
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
    made["sensor"] = {name: value for name, value in made["sensor"].items() if name not in _LEFT_OUT}
    tracing = {**made.get("tracing", {}), "direction": "adjoint", "sharing": 1}
    made["tracing"] = {
        name: value for name, value in tracing.items() if not name.startswith(("aim", "forward"))
    }
    return made


def sunny_sky(picture: Path, patches: Patches, sunny: NDArray[np.intp]) -> None:
    """Writes a sky of 1 in some patches alone."""
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
    pixels = np.repeat(lit[..., None], 3, axis=-1).astype(np.float32)
    written = oiio.ImageBuf(oiio.ImageSpec(columns, rows, 3, oiio.FLOAT))
    written.set_pixels(written.roi, pixels)
    if not written.write(str(picture)):
        raise OSError(f"{picture} can't be written: {written.geterror()}")


def sunny_environment(sha256: str, up: Floats, north: Floats) -> dict[str, Any]:
    """A sky of 1 cd/m2 where the picture of that digest has 1."""
    return {
        "asset": DIGEST_PREFIX + sha256,
        "luminance": 1.0,
        "up": up.tolist(),
        "forward": north.tolist(),
    }


def see_as_melanopsin(sensor: scene_pb2.Sensor) -> None:
    """Changes the responses of a compiled scene: daylight of 1 lx and D65 reads 1 (CIE S 026/E:2018)."""
    wavelengths = published.visible_wavelengths()
    action = published.alpha_opic_spectra()[:, published.ALPHA_OPIC.index("melanopic")]
    curve = np.interp(wavelengths, published.colour_wavelengths(), action, left=0.0, right=0.0)
    daylight = np.interp(wavelengths, *published.illuminant("D65"))
    seen = response()[:, 1]
    curve = curve * (seen @ daylight) / (curve @ daylight)
    for of_sensor in (sensor.response_x, sensor.response_y, sensor.response_z):
        of_sensor[:] = curve.tolist()


class DaylightStudy:
    """A document whose meters measure daylight coefficients, and what a program needs to count them."""

    def __init__(self, document: SceneDocument, year: YearOfDaylight, blobs: BlobStore) -> None:
        """Puts a picture of the Sun's patches into the store. Raises InputError and NotFound."""
        self._year, self._layout = year, layout_of(year)
        self.up, self.north = frame_of(document, year.north)
        self.skies = skies_of(weather_of(year, blobs), self._layout.sky, 0.0)
        given = document.model_dump(mode="json", exclude_unset=True)
        made = sky_alone(given)
        if year.of == "sun_reflected":
            if not len(self._layout.sunny(self.skies)):
                raise InputError.at(_WEATHER, "the Sun shines in none of the hours")
            made["environment"] = self._sunny(blobs)
        self.document = check_document(made)
        """What is traced."""
        self.message = self._message()
        """What is counted."""
        self._check_size(document)

    def film(self, film: Film) -> Film:
        """Of one batch, with the samples of all."""
        batches = self._year.batches
        return Film(film.width, film.height // batches, film.samples * batches)

    def finish(self, scene: scene_pb2.CompiledScene) -> None:
        """Puts it into the compiled scene."""
        scene.daylight.CopyFrom(self.message)
        if self._year.melanopic:
            see_as_melanopsin(scene.sensor)

    def _sunny(self, blobs: BlobStore) -> dict[str, Any]:
        with tempfile.TemporaryDirectory(prefix="nocturne-daylight-") as name:
            picture = Path(name) / "suns.exr"
            sunny_sky(picture, self._layout.suns, self._layout.sunny(self.skies))
            return sunny_environment(blobs.put(picture.read_bytes()), self.up, self.north)

    def _message(self) -> scene_pb2.DaylightCoefficients:
        reflected = self._year.of == "sun_reflected"
        patches = self._layout.suns if reflected else self._layout.sky
        made = scene_pb2.DaylightCoefficients(
            divisions=patches.divisions,
            up=_vector(self.up),
            north=_vector(self.north),
            patches=self._layout.sunny(self.skies).tolist() if reflected else (),
            reflected_alone=reflected,
        )
        if self._year.of == "sun_straight":
            towards = in_scene(self.skies.sun_towards[self.skies.sunny], self.up, self.north)
            made.suns.extend(scene_pb2.Vector(x=x, y=y, z=z) for x, y, z in towards.tolist())
            if not made.suns:
                raise InputError.at(_WEATHER, "the Sun shines in none of the hours")
        return made

    def _check_size(self, document: SceneDocument) -> None:
        assert isinstance(document.sensor, Meters)  # noqa: S101 - no other has a year of daylight
        width, height = document.sensor.layout()[0]
        size = 8.0 * width * height * self._year.batches * coefficients_of(self.message)
        if size > _MOST_BYTES:
            raise InputError.at(
                "$.sensor.instruments",
                f"{width} x {height} meters in {self._year.batches} batches have {size / 1e9:.1f} GB of "
                f"daylight coefficients; at most {_MOST_BYTES / 1e9:g}",
            )


def _vector(values: Floats) -> scene_pb2.Vector:
    # The nine digits by which a program is told a float32.
    x, y, z = (float(f"{value:.9g}") for value in values)
    return scene_pb2.Vector(x=x, y=y, z=z)
