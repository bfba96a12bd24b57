"""Which method to show images a terminal knows; the methods are in terminal.py, which needs numpy."""

from collections.abc import Mapping
from enum import Enum


class Graphics(Enum):
    """How a terminal shows images."""

    KITTY = "kitty"
    ITERM2 = "iterm2"
    SIXEL = "sixel"


def graphics_of(environment: Mapping[str, str]) -> Graphics | None:
    """What the terminal that the environment describes can do; None: nothing that is known.

    Multiplexers pass none of it on by themselves.
    """
    program, term = environment.get("TERM_PROGRAM", ""), environment.get("TERM", "")
    if "TMUX" in environment or term.startswith("screen"):
        return None
    if "KITTY_WINDOW_ID" in environment or "kitty" in term or program == "ghostty":
        return Graphics.KITTY
    if program in ("iTerm.app", "WezTerm") or environment.get("LC_TERMINAL") == "iTerm2":
        return Graphics.ITERM2
    known = ("foot", "mlterm", "contour", "sixel")
    return Graphics.SIXEL if any(word in term for word in known) else None
