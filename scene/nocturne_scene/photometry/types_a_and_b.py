"""Photometry of types A and B (ANSI/IESNA LM-63-2002, section 3): intensities about another axis.

D is straight down, Z the photometric horizontal (plane C0 of type C), S to its right for somebody who stands
at the luminaire and looks along Z, as horizontal angles of both types increase clockwise seen from above. A
direction at the horizontal angle H and the vertical angle V is

    type A  cos V (cos H Z + sin H S) - sin V D    planes share the vertical axis, (0, 0) is Z
    type B  cos H (cos V D + sin V Z) + sin H S    planes share the horizontal axis S, (0, 0) is D

Both are angles from an axis and about it, as those of type C are: from D about D, and from S about S. So
intensities are linear between the angles of the file, and none is interpolated to other angles.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from nocturne_scene.spectra.published import Floats

Vector = tuple[float, float, float]
"""In D, Z and S."""

DOWN: Vector = (1.0, 0.0, 0.0)
C0: Vector = (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class AboutAnAxis:
    """Intensities from an axis and about it, as of type C."""

    vertical: Floats
    """From the axis, degrees."""
    horizontal: Floats
    """About it from `zero`, counter-clockwise for someone who looks along it; from 0 on."""
    candela: Floats
    axis: Vector
    zero: Vector


def about_an_axis(
    kind: Literal["A", "B"], vertical: Floats, horizontal: Floats, candela: Floats
) -> AboutAnAxis:
    """From increasing angles of a file, and intensities of shape (horizontal, vertical). Horizontal ones from
    0 on stand for both sides."""
    if horizontal[0] == 0:
        horizontal = np.append(-horizontal[:0:-1], horizontal)
        candela = np.concatenate([candela[:0:-1], candela])
    # In both types the angle about the axis increases the other way round, from the last one on.
    type_b = kind == "B"
    around, away = (vertical, -horizontal[::-1]) if type_b else (horizontal, vertical)
    values = candela[::-1].T if type_b else candela
    last = np.deg2rad(around[-1])
    cosine, sine = float(np.cos(last)), float(np.sin(last))
    return AboutAnAxis(
        away + 90.0,
        (around[-1] - around)[::-1],
        values[::-1],
        axis=(0.0, 0.0, 1.0) if type_b else DOWN,
        zero=(cosine, sine, 0.0) if type_b else (0.0, cosine, sine),
    )
