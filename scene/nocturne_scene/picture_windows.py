"""Windows of OpenEXR files: pixels are those of a data window, a picture is what the display window shows."""

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

_Kind = TypeVar("_Kind", bound=np.generic)

Window = tuple[int, int, int, int]
"""x, y, width, height."""


def windows_of(spec: Any) -> tuple[Window, Window]:
    """Data window and display window of a file, by OpenImageIO's ImageSpec."""
    data = (spec.x, spec.y, spec.width, spec.height)
    return data, (spec.full_x, spec.full_y, spec.full_width, spec.full_height)


def in_window(pixels: NDArray[_Kind], data: Window, display: Window) -> NDArray[_Kind]:
    """What the display window shows of pixels of a data window, 0 where there are none.

    Shape (rows, columns, ...), whose size is the display window's: check that before.
    """
    left, top, width, height = display
    shown = np.zeros((height, width, *pixels.shape[2:]), pixels.dtype)
    x, y = data[0] - left, data[1] - top
    rows = slice(max(y, 0), max(min(y + data[3], height), 0))
    columns = slice(max(x, 0), max(min(x + data[2], width), 0))
    part = shown[rows, columns]
    part[:] = pixels[rows.start - y :, columns.start - x :][: part.shape[0], : part.shape[1]]
    return shown
