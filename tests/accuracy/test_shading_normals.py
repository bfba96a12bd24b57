"""Normal and bump maps under light of radiance 1 from everywhere, against paper and quadrature.

Directions count that are in front of the surface and of the shading normal; cosines are the shading
normal's. A white Lambertian plane whose normal is tilted by t then shows (1 + cos t) / 2, the share of the
sky that a plane tilted by t sees above the ground.
"""

from math import cos, radians, sin, tan
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_scene.validation.documents import diffuse, measured_scene, quad, surface

from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.tracing import Document
from tests.pictures import write_exr

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

Pixels = npt.NDArray[np.float32]

# Reflects all but 4e-7 along the normal, and less than 1e-6 at other angles.
_MIRROR = {"n": 0.001, "k": 100.0}
_ALPHA = 0.25
_COLUMNS = 64
_PERIODS = 16
_SHADING_NORMAL = 30.0


def _saved(pixels: Pixels, folder: Path) -> Document:
    """A picture as a texture."""
    write_exr(folder / "picture.exr", pixels, "RGB" if pixels.shape[2] == 3 else "Y")
    return {"asset": "picture.exr"}


def _normals(tilts: npt.NDArray[np.float64], folder: Path) -> Document:
    """A normal map whose columns are tilted towards +x by so many degrees."""
    angles = np.radians(tilts)
    normals = np.stack([np.sin(angles), 0.0 * angles, np.cos(angles)], axis=-1)
    return _saved(np.tile((0.5 + 0.5 * normals).astype(np.float32), (_COLUMNS, 1, 1)), folder)


def _lit(sensor: Document, kernel: Document, **maps: Document) -> Document:
    plate = surface(quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]), kernel) | maps
    return measured_scene(sensor, [plate]) | {"environment": {"radiance": 1.0}}


def _seen_at(degrees: float, tilt: float, kernel: Document, folder: Path, samples: int) -> Reading:
    """A plane with one shading normal, seen from an angle towards +x."""
    sensor = {
        "type": "radiance_meter",
        "position": [0.1 * sin(radians(degrees)), 0.0, 0.1 * cos(radians(degrees))],
        "look_at": [0, 0, 0],
        "diameter": 1e-4,
        "cone_degrees": 1e-3,
    }
    document = _lit(sensor, kernel, normal_map={"texture": _normals(np.full(4, tilt), folder)})
    return Measurement(document, folder, 16, 16).by_pixels(samples)


@pytest.mark.parametrize("degrees", [0.0, 50.0, -50.0])
@pytest.mark.parametrize("tilt", [10.0, 30.0, 60.0])
def test_a_tilted_normal_sees_its_share_of_the_sky(tilt: float, degrees: float, tmp_path: Path) -> None:
    """From behind the shading normal, the surface's own counts. False alarms: 0.01 for each."""
    behind = tilt - degrees > 90.0
    truth = 1.0 if behind else (1.0 + cos(radians(tilt))) / 2.0
    _seen_at(degrees, tilt, diffuse(1.0), tmp_path, 2048).check(truth, 5e-5)


def _rough_mirror(degrees: float, tilt: float) -> float:
    """GGX with height-correlated masking, integrated over the surface's half-sphere."""
    nodes, weights = np.polynomial.legendre.leggauss(600)
    cosine = 0.5 * (nodes[:, None] + 1.0)
    turn = 2.0 * np.pi * (np.arange(1440) + 0.5) / 1440.0
    sine = np.sqrt(1.0 - cosine**2)
    across, along, up = sine * np.cos(turn), sine * np.sin(turn), cosine + 0.0 * turn
    t, v = radians(tilt), radians(degrees - tilt)
    # In the frame of the shading normal.
    x, z = cos(t) * across - sin(t) * up, sin(t) * across + cos(t) * up
    half = np.stack([x + sin(v), along, z + cos(v)])
    half_z = half[2] / np.linalg.norm(half, axis=0)
    density = _ALPHA**2 / (np.pi * (half_z**2 * (_ALPHA**2 - 1.0) + 1.0) ** 2)

    def masking(c: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return 0.5 * (np.sqrt(1.0 + _ALPHA**2 * (1.0 / c**2 - 1.0)) - 1.0)

    seen = z > 0.0
    both = 1.0 + masking(np.where(seen, z, 1.0)) + masking(np.array(cos(v)))
    values = np.where(seen, density / both / (4.0 * cos(v)), 0.0)
    return float((0.5 * weights[:, None] * values).sum() * 2.0 * np.pi / 1440.0)


@pytest.mark.parametrize(("degrees", "tilt"), [(0.0, 20.0), (40.0, 20.0), (-40.0, 20.0), (-40.0, 40.0)])
def test_a_rough_mirror_with_a_tilted_normal(degrees: float, tilt: float, tmp_path: Path) -> None:
    """False alarms: 0.01 for each."""
    kernel = {"type": "conductor", "roughness": _ALPHA, "index": _MIRROR}
    reading = _seen_at(degrees, tilt, kernel, tmp_path, 512)
    reading.check(_rough_mirror(degrees, tilt), 1e-4)


def _grooves(folder: Path, **maps: Document) -> Reading:
    """Each pixel sees one groove as a whole."""
    sensor = {
        "type": "orthographic",
        "position": [0, 0, 1],
        "look_at": [0, 0, 0],
        "up": [0, 1, 0],
        "height": 1,
    }
    return Measurement(_lit(sensor, diffuse(1.0), **maps), folder, 8, 8).by_pixels(1024)


def test_grooves_finer_than_a_pixel_by_normals(tmp_path: Path) -> None:
    """The mean over a pixel is that of what its normals reflect, and not what its mean normal reflects: 1.

    Truth: normals are interpolated between the columns, in the picture's numbers.
    """
    tilts = np.where(np.arange(_COLUMNS) < _COLUMNS // 2, _SHADING_NORMAL, -_SHADING_NORMAL)
    angle = np.radians(_SHADING_NORMAL)
    between = sin(angle) * np.linspace(-1.0, 1.0, 10_001)
    edges = float(np.mean(cos(angle) / np.hypot(between, cos(angle))))
    mean = (cos(angle) * (_COLUMNS - 2) + edges * 2) / _COLUMNS
    use = {"texture": _normals(tilts, tmp_path), "scale": [_PERIODS, _PERIODS]}
    _grooves(tmp_path, normal_map=use).check((1.0 + mean) / 2.0, 5e-5)


def test_grooves_finer_than_a_pixel_by_heights(tmp_path: Path) -> None:
    """A repeated picture of a ridge, slopes up and down alike.

    Slopes are differences over 2^-10 of the picture, so that 4 * 2^-11 of it is between both slopes: less
    than 1.4e-4 of the light.
    """
    half = _COLUMNS // 2
    heights = 1.0 - np.abs(np.arange(_COLUMNS) - half) / half
    texture = _saved(np.tile(heights.astype(np.float32)[None, :, None], (_COLUMNS, 1, 1)), tmp_path)
    # The plane is 2 m wide; a slope of 1 in the picture's numbers is over half a period.
    height = tan(radians(_SHADING_NORMAL)) * 0.5 * 2.0 / _PERIODS
    use = {"texture": texture, "scale": [_PERIODS, _PERIODS], "height": height}
    truth = (1.0 + cos(radians(_SHADING_NORMAL))) / 2.0
    _grooves(tmp_path, bump_map=use).check(truth, 1.4e-4 / truth + 5e-5)
