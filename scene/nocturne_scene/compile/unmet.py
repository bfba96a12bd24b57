"""What a pilot found that a render may not meet, in sentences."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

TOLD_ABOVE = 0.005
"""Part of the mean that may be missing and is told: the error that most renders are asked for."""

_NAMED = 5
"""Rectangles of an image that are named one by one; the others are counted, and named by one around them."""

_MANY = 10.0
"""So many times what is seen, and more, are no longer said as a percentage."""


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
        """By its first and last pixels, from the upper left corner."""
        return f"x {_span(self.left, self.right)} y {_span(self.top, self.bottom)}"


def unmet_light(part: float, direction: str = "both") -> str:
    """What to say where so large a part of the mean may be missing; nothing where it is small.

    `direction`: how photons from luminaires can take part.
    """
    if part < TOLD_ABOVE:
        return ""
    return (
        "; the pilot met too few photons that mirrors and glass gather to compare, so that up to "
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
    named = [(each.named(), each.part) for each in groups[:_NAMED]]
    if rest := groups[_NAMED:]:
        areas = f"{len(rest)} smaller area{'s' if len(rest) > 1 else ''}"
        around = _around(rest)
        named.append((f"{areas} within {around.named()}", around.part))
    (first, part), *others = named
    places = [f"{first} (up to {_times(part)} {'of ' if part < _MANY else ''}the light shown there)"]
    places += [f"{name} (up to {_times(part)})" for name, part in others]
    return (
        "; reflections, refractions or caustics of small bright light sources may be missing, which the "
        f"standard errors do not show, at pixels {', '.join(places)}"
    )


def named_pixels(said: str) -> list[tuple[slice, slice]]:
    """Rows and columns of the rectangles that a sentence of `unmet_parts` names."""
    found = re.findall(r"x (\d+)(?: to (\d+))? y (\d+)(?: to (\d+))? \(up to", said)
    return [
        (slice(int(top), int(bottom or top) + 1), slice(int(left), int(right or left) + 1))
        for left, right, top, bottom in found
    ]


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


def _span(first: int, end: int) -> str:
    return f"{first}" if end - first == 1 else f"{first} to {end - 1}"


def _times(part: float) -> str:
    """Of what is seen."""
    return f"{part:.0%}" if part < _MANY else f"{part:.0f} times"
