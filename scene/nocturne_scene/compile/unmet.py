"""What a pilot found that a render may not meet, in sentences."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

TOLD_ABOVE = 0.005
"""Part of the mean that may be missing and is told: the error that most renders are asked for."""

_NAMED = 5
"""Rectangles of an image that are named one by one; all others together are one more."""


@dataclass(frozen=True)
class Rectangle:
    """Pixels, `right` and `bottom` not among them."""

    left: int
    top: int
    right: int
    bottom: int
    part: float
    """What may be missing there, in parts of what is seen."""

    def touches(self, other: "Rectangle") -> bool:
        return (
            self.left <= other.right
            and other.left <= self.right
            and self.top <= other.bottom
            and other.top <= self.bottom
        )

    @property
    def area(self) -> int:
        return (self.right - self.left) * (self.bottom - self.top)

    def named(self) -> str:
        across, down = f"{self.left} to {self.right}", f"{self.top} to {self.bottom}"
        return f"across {across}, down {down} (up to {_times(self.part)})"


def unmet_light(part: float, direction: str = "both") -> str:
    """What to say where so large a part of the mean may be missing; nothing where it is small.

    `direction`: how photons from luminaires can take part.
    """
    if part < TOLD_ABOVE:
        return ""
    return (
        "; it met too few photons that mirrors and glass gather to compare, so that up to "
        f'{part:.1%} of the mean may be missing: `"direction": "{direction}"` would find it'
    )


def unmet_parts(found: Iterable[Sequence[float]]) -> str:
    """What to say of the rectangles in which the render may miss light: left, top, width and height in
    pixels, and what may be missing in parts of what is seen there. Nothing where there are none.
    """
    rectangles = [Rectangle(int(x), int(y), int(x + w), int(y + h), part) for x, y, w, h, part in found]
    if not rectangles:
        return ""
    groups = sorted(_touching(rectangles), key=lambda each: each.area, reverse=True)
    named = groups[:_NAMED]
    if rest := groups[_NAMED:]:
        named.append(_around(rest))
    return (
        "; parts of the image are not to be trusted, as mirrors or glass show or gather light of small lamps "
        "there that so few samples may miss, and errors do not tell of it: pixels "
        + "; ".join(each.named() for each in named)
    )


def _touching(rectangles: list[Rectangle]) -> list[Rectangle]:
    groups: list[Rectangle] = []
    for each in rectangles:
        near = [group for group in groups if group.touches(each)]
        groups = [group for group in groups if group not in near]
        groups.append(_around([each, *near]))
    return groups


def _around(all_of: list[Rectangle]) -> Rectangle:
    return Rectangle(
        min(each.left for each in all_of),
        min(each.top for each in all_of),
        max(each.right for each in all_of),
        max(each.bottom for each in all_of),
        max(each.part for each in all_of),
    )


def _times(part: float) -> str:
    """Of what is seen."""
    return f"{part:.0%}" if part < 10.0 else f"{part:.0f} times"
