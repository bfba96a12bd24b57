"""Writes the environment map of this scene: a sky, a ground, and a small bright window."""

import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation

WIDTH, HEIGHT = 512, 256

# Linear sRGB.
ZENITH, HORIZON, GROUND = (0.25, 0.45, 0.9), (0.9, 0.95, 1.0), (0.2, 0.17, 0.14)
WINDOW = (250.0, 220.0, 180.0)

# Pixels: rows, columns.
WINDOW_ROWS, WINDOW_COLUMNS = slice(60, 76), slice(330, 346)


def pixels() -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
    """The map as latitude and longitude, shape (HEIGHT, WIDTH, 3)."""
    height = np.cos(np.pi * (np.arange(HEIGHT) + 0.5) / HEIGHT)[:, None, None]
    sky = np.array(HORIZON) + (np.array(ZENITH) - np.array(HORIZON)) * np.sqrt(np.maximum(height, 0))
    rows = np.where(height > 0, sky, np.array(GROUND))
    image = np.repeat(rows, WIDTH, axis=1)
    image[WINDOW_ROWS, WINDOW_COLUMNS] = WINDOW
    return image.astype(np.float32)


def main(folder: Path) -> None:
    """Write sky.exr into `folder`."""
    picture = oiio.ImageBuf(oiio.ImageSpec(WIDTH, HEIGHT, 3, oiio.FLOAT))
    picture.set_pixels(oiio.ROI(), pixels())
    if not picture.write(str(folder / "sky.exr")):
        raise OSError(picture.geterror())


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
