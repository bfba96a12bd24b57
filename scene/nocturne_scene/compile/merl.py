"""Measured BRDFs of the MERL database as the tracer's table.

W. Matusik, H. Pfister, M. Brand and L. McMillan, "A data-driven reflectance model", ACM Transactions on
Graphics 22(3), 2003. A file holds three little-endian int32, theta_h 90, theta_d 90, phi_d 180, then as many
float64 for each of red, green and blue. theta_h has quadratic steps ((i / 90)^2 of a right angle), the others
equal ones; phi_d covers half a turn.
"""

import struct

import numpy as np
from numpy.typing import NDArray

# Numbers of cells.
THETA_H, THETA_D, PHI_D = 90, 90, 180
_CELLS = THETA_H * THETA_D * PHI_D
FILE_BYTES = 12 + 3 * 8 * _CELLS

# What the stored integers of each channel stand for, as the database's reading code has it, in sr-1.
_SCALES = (1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0)


class BadMerlError(Exception):
    """The file is no MERL table; the message says why."""


def read(data: bytes) -> NDArray[np.float32]:
    """Return BRDF values in sr-1, shape (3, 90, 90, 180): channel, theta_h, theta_d, phi_d.

    Cells that were not measured are negative in the file, and 0 here. Raises BadMerlError.
    """
    if len(data) != FILE_BYTES:
        raise BadMerlError(f"the file has {len(data)} bytes; a MERL table has {FILE_BYTES}")
    sizes = struct.unpack("<3i", data[:12])
    if sizes != (THETA_H, THETA_D, PHI_D):
        raise BadMerlError(
            f"the table has {sizes[0]} x {sizes[1]} x {sizes[2]} cells; expected 90 x 90 x 180"
        )
    values = np.frombuffer(data, dtype="<f8", offset=12).reshape(3, THETA_H, THETA_D, PHI_D)
    if not np.all(np.isfinite(values)):
        raise BadMerlError("the table holds infinite or undefined numbers")
    scales = np.array(_SCALES)[:, None, None, None]
    return np.asarray(np.maximum(values, 0.0) * scales, dtype=np.float32)
