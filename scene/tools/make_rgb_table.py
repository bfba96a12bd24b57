"""Makes nocturne_scene/data/rgb_table.bin. Run again only if the method in rgb_spectra.py
changes.

python coordinator/tools/make_rgb_table.py scene/nocturne_scene/data/rgb_table.bin

Some three minutes. The same bytes come out with the packages of requirements.lock on a machine with AVX-512:
linear algebra runs in one thread and with one kind of kernel, as near black many spectra have the same colour
and the order of sums decides which of them is found.
"""

import os
import sys
from pathlib import Path

# Read when NumPy loads.
os.environ |= {"OPENBLAS_NUM_THREADS": "1", "OPENBLAS_CORETYPE": "Haswell"}

import numpy as np
from nocturne_scene.spectra.published import Floats
from nocturne_scene.spectra.rgb import Table, gauss_newton, unscaled

RESOLUTION = 32

# A colour channel of exactly 0 or 1 would ask for an infinite argument of the sigmoid.
MARGIN = 2e-4


def scales(resolution: int) -> Floats:
    """Brightest channels: close together near 0 and 1, where coefficients change fastest (the paper's
    spacing).
    """
    t = np.linspace(0, 1, resolution)
    for _ in range(2):
        t = t * t * (3 - 2 * t)
    return t


def fitted(resolution: int, brightest: int) -> Floats:
    """Coefficients in nm, shape (resolution, resolution, resolution, 3), for one brightest channel.

    Each slice starts from its neighbour's result, from the middle scale outwards, as smooth tables
    interpolate well.
    """
    at = scales(resolution)
    ratios = np.linspace(0, 1, resolution)
    second, first = (axis.ravel() for axis in np.meshgrid(ratios, ratios, indexing="ij"))
    colour = np.empty((resolution**2, 3))
    colour[:, brightest], colour[:, (brightest + 1) % 3], colour[:, (brightest + 2) % 3] = 1.0, first, second
    result = np.empty((resolution, resolution**2, 3))
    middle = resolution // 2
    for order in (range(middle, resolution), range(middle - 1, -1, -1)):
        start = np.zeros((resolution**2, 3)) if order.start == middle else result[middle]
        for slice_index in order:
            rgb = np.clip(at[slice_index] * colour, MARGIN, 1 - MARGIN)
            start, error = gauss_newton(rgb, start)
            result[slice_index] = start
            print(f"brightest {brightest}, scale {at[slice_index]:.4f}: largest error {error.max():.1e}")  # noqa: T201
    return unscaled(result).reshape(resolution, resolution, resolution, 3)


def main() -> None:
    """Make the table and write it to the file that is named."""
    coefficients = np.stack([fitted(RESOLUTION, brightest) for brightest in range(3)])
    table = Table(scales(RESOLUTION).astype(np.float32), coefficients.astype(np.float32))
    Path(sys.argv[1]).write_bytes(table.blob())


if __name__ == "__main__":
    main()
