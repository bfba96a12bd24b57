"""From X, Y, Z to what a screen shows."""

import numpy as np
import numpy.typing as npt

# IEC 61966-2-1: XYZ of white D65 to linear sRGB; transposed, for rows of pixels.
_XYZ_TO_SRGB = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]], dtype=np.float32
).T
_MIDDLE_GREY = 0.18


def linear_srgb(xyz: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Linear sRGB of the same shape (..., 3) and scale; may be negative outside its gamut."""
    converted: npt.NDArray[np.float32] = xyz @ _XYZ_TO_SRGB
    return converted


def shown(xyz: npt.NDArray[np.float32]) -> npt.NDArray[np.uint8]:
    """sRGB bytes, exposed by the image itself: the logarithmic mean of Y becomes middle grey.

    Reinhard, Stark, Shirley, Ferwerda (2002), equations 1 to 3.
    """
    y = xyz[..., 1]
    lit = y[y > 0]
    exposure = _MIDDLE_GREY / float(np.exp(np.mean(np.log(lit)))) if lit.size else 1.0
    linear = np.clip(exposure * linear_srgb(xyz) / (1.0 + exposure * np.maximum(y, 0))[..., None], 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    quantised: npt.NDArray[np.uint8] = np.rint(255 * encoded).astype(np.uint8)
    return quantised
