"""Images of what an eye sees, made up of discs of light before an even background."""

import numpy as np
import numpy.typing as npt
from nocturne_scene.photometry.directions import Projection, directions_of
from nocturne_scene.uncertainty import ImageMoments

Values = npt.NDArray[np.float64]
PANORAMA = (512, 256)
FISHEYE = (384, 384)


def image_of(y: Values, error: float = 0.0) -> ImageMoments:
    """Of pixels that know nothing of each other, with relative standard errors."""
    mean = np.repeat(y[..., None], 3, axis=-1)
    variance = (error * mean) ** 2
    return ImageMoments(
        mean,
        variance,
        np.zeros_like(variance),
        variance.copy(),
        np.zeros((*(-(-edge // 4) for edge in y.shape), 6)),
        np.zeros((1, 1, 3)),
        max(y.shape),
        np.full(y.shape, 16, dtype=np.uint32),
    )


def with_sources(
    projection: Projection,
    sources: list[tuple[float, float, float, float]],
    background: float,
    size: tuple[int, int] | None = None,
) -> Values:
    """Discs: azimuth and elevation in degrees, half angle in degrees, luminance."""
    seen = directions_of(projection, *(size or (PANORAMA if projection == "panorama" else FISHEYE)))
    y = np.full(seen.solid_angle.shape, background)
    for azimuth, elevation, half, luminance in sources:
        a, e = np.deg2rad([azimuth, elevation])
        middle = np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)])
        y[seen.direction @ middle > np.cos(np.deg2rad(half))] = luminance
    return y
