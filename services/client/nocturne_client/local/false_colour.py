"""Colours of values in steps."""

from collections.abc import Sequence

import numpy as np

# Of viridis (S. van der Walt, N. Smith, 2015), from dark to bright.
COLOURS = (
    "#440154",
    "#482878",
    "#3e4989",
    "#31688e",
    "#26828e",
    "#1f9e89",
    "#35b779",
    "#6ece58",
    "#b5de2b",
    "#fde725",
)


def step_colour(value: float, steps: Sequence[float]) -> str:
    """The colour of a value among at most nine increasing steps, the first one below all of them."""
    return COLOURS[int(np.searchsorted(steps, value, side="right"))]


def ink_on(colour: str) -> str:
    """Black or white, whichever is read better on a colour, #rrggbb."""
    red, green, blue = (int(colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5))
    # Luma of ITU-R BT.709.
    return "#000000" if 0.2126 * red + 0.7152 * green + 0.0722 * blue > 0.45 else "#ffffff"
