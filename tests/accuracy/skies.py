"""CIE general skies as environment maps, and the irradiance from them by quadrature."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.textures.environment_maps import equal_area_rows, turned
from nocturne_scene.textures.pictures import opened
from nocturne_scene.validation import skies

from tests.accuracy.agreement import Values

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
        return skies.luminance(self.kind, directions)

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
