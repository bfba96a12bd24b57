"""CIE general skies as environment maps, and the irradiance from them by quadrature."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.textures.environment_maps import equal_area_rows, turned
from nocturne_scene.textures.pictures import opened

from tests.accuracy.agreement import Values

# ISO 15469:2004 (CIE S 011/E:2003), table 1: gradation a, b; indicatrix c, d, e. Type 16 is the CIE
# traditional overcast sky of Moon and Spencer (1942), L = (1 + 2 cos z) / 3.
_TYPES = {
    1: (4.0, -0.70, 0.0, -1.0, 0.0),
    2: (4.0, -0.70, 2.0, -1.5, 0.15),
    5: (0.0, -1.0, 0.0, -1.0, 0.0),
    7: (0.0, -1.0, 5.0, -2.5, 0.30),
    8: (0.0, -1.0, 10.0, -3.0, 0.45),
    12: (-1.0, -0.32, 10.0, -3.0, 0.45),
}

WIDTH, HEIGHT = 512, 256

ORIENTATION = {"up": [1, 0, 0], "forward": [0, 0, 1]}
"""Of the maps: the zenith is in the middle of the picture, where texels are small and nearly square, and the
horizon is between columns. The map's axes x, y, z are the scene's z, -y, x."""


@dataclass(frozen=True)
class Sky:
    """A type of sky; the sun stands at 60 degrees above +y, z is up. Luminance 1 at the zenith."""

    kind: int

    def luminance(self, directions: Values) -> Values:
        """Of unit vectors, shape (..., 3), above the horizon; 0 below it."""
        z = directions[..., 2]
        sun = np.array([0.0, np.cos(np.pi / 3), np.sin(np.pi / 3)])
        above = z > 0.0
        z = np.where(above, z, 1.0)
        if self.kind == 16:
            return np.where(above, (1.0 + 2.0 * z) / 3.0, 0.0)
        a, b, c, d, e = _TYPES[self.kind]

        def indicatrix(angle: Values) -> Values:
            tail: Values = 1.0 + c * (np.exp(d * angle) - np.exp(d * np.pi / 2)) + e * np.cos(angle) ** 2
            return tail

        from_sun = np.arccos(np.clip(directions @ sun, -1.0, 1.0))
        gradation = (1.0 + a * np.exp(b / z)) / (1.0 + a * np.exp(b))
        at_zenith = indicatrix(np.asarray(np.pi / 6))
        return np.where(above, gradation * indicatrix(from_sun) / at_zenith, 0.0)

    def write(self, path: Path) -> None:
        """A latitude-longitude picture for ORIENTATION. Means over 4 x 4 points in each pixel."""
        polar = (np.arange(HEIGHT * 4) + 0.5) * np.pi / (HEIGHT * 4)
        azimuth = np.pi - (np.arange(WIDTH * 4) + 0.5) * 2.0 * np.pi / (WIDTH * 4)
        sine = np.sin(polar)[:, None]
        x = np.broadcast_to(np.cos(polar)[:, None], (HEIGHT * 4, WIDTH * 4))
        directions = np.stack([x, -sine * np.sin(azimuth), sine * np.cos(azimuth)], axis=-1)
        fine = self.luminance(directions) * sine
        blocks = fine.reshape(HEIGHT, 4, WIDTH, 4).sum(axis=(1, 3))
        weights = 4.0 * sine.reshape(HEIGHT, 4).sum(axis=1)[:, None]
        grey = np.repeat((blocks / weights)[..., None], 3, axis=-1).astype(np.float32)
        output = oiio.ImageOutput.create(str(path))
        assert output is not None
        output.open(str(path), oiio.ImageSpec(WIDTH, HEIGHT, 3, oiio.FLOAT))
        output.write_image(grey)
        output.close()


def horizontal_illuminance(sky: Sky) -> float:
    """Of open ground: the integral of luminance times cosine over the upper half-sphere."""
    nodes, weights = np.polynomial.legendre.leggauss(400)
    z, dz = 0.5 * (nodes + 1.0), 0.5 * weights
    azimuth = (np.arange(800) + 0.5) * 2.0 * np.pi / 800
    sine = np.sqrt(1.0 - z**2)[:, None]
    directions = np.stack(
        [sine * np.cos(azimuth), sine * np.sin(azimuth), np.broadcast_to(z[:, None], (400, 800))], axis=-1
    )
    return float((sky.luminance(directions).mean(axis=1) * 2.0 * np.pi * z * dz).sum())


@lru_cache(maxsize=1)
def _texels(picture: Path) -> Values:
    """Of equal area, luminance only. Nobody writes a picture twice."""
    with opened(picture) as image:
        rows = iter(image.read_image(0, 0, 0, 3, oiio.FLOAT))
    return np.stack([turned(row) for row in equal_area_rows(rows, HEIGHT)])[..., 0]


def map_luminance(picture: Path, directions: Values) -> Values:
    """What the compiler makes of a picture that `Sky.write` wrote."""
    texels = _texels(picture)
    row = np.clip((1.0 - directions[..., 0]) / 2.0 * HEIGHT, 0, HEIGHT - 1).astype(int)
    azimuth = np.arctan2(-directions[..., 1], directions[..., 2]) % (2.0 * np.pi)
    column = np.clip(azimuth / (2.0 * np.pi) * WIDTH, 0, WIDTH - 1).astype(int)
    return np.asarray(texels[row, column], dtype=np.float64)
