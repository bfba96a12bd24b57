"""What a pilot found that a render may not meet, as warnings."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace

from nocturne_scene.render_warnings import RenderWarning, UnmetPart, WarningKind

TOLD_ABOVE = 0.005
"""A part of the mean that may be missing and is reported: the error that most renders are asked for."""

_NAMED = 5
"""Rectangles that a sentence names one by one; it counts the others, and names one around them."""

_MANY = 10.0
"""From so many times the visible light on, no percentage is shown."""

_ANY = 1e6
"""As many times and more where next to nothing is seen."""

_PARTS = 200
"""Rectangles of a warning, which goes with each event of its render; more are reported by coarser squares."""


def unmet_light(part: float, direction: str = "both") -> RenderWarning | None:
    """What to say where so large a part of the mean may be missing; None where it is small.

    `direction`: how photons from luminaires can take part.
    """
    if part < TOLD_ABOVE:
        return None
    return RenderWarning(
        WarningKind.MISSING_LIGHT,
        "the pilot met too few photons that mirrors and glass gather to compare, so that up to "
        f'{part:.1%} of the mean may be missing: `"direction": "{direction}"` would find it',
    )


def unmet_parts(found: Iterable[Sequence[float]]) -> RenderWarning | None:
    """The warning of rectangles in which the render may miss light: left, top, width and height in pixels,
    and the light that may be missing, in parts of the light there. None where there are none.
    """
    rectangles = [UnmetPart(int(x), int(y), int(w), int(h), part) for x, y, w, h, part in found]
    if not rectangles:
        return None
    groups = sorted(_touching(rectangles), key=lambda each: each.width * each.height, reverse=True)
    named = [(_name(each), each.part) for each in groups[:_NAMED]]
    if rest := groups[_NAMED:]:
        areas = f"{len(rest)} smaller area{'s' if len(rest) > 1 else ''}"
        around = _around(rest)
        named.append((f"{areas} within {_name(around)}", around.part))
    (first, part), *others = named
    places = [f"{first} (up to {_times(part)} {'of ' if part < _MANY else ''}the light shown there)"]
    places += [f"{name} (up to {_times(part)})" for name, part in others]
    return RenderWarning(
        WarningKind.MISSING_IN_PARTS,
        "reflections, refractions or caustics of small bright light sources may be missing, which the "
        f"standard errors do not show, at pixels {', '.join(places)}",
        tuple(_few(rectangles)),
    )


def _few(rectangles: list[UnmetPart]) -> list[UnmetPart]:
    """All their pixels in fewer rectangles; if these are many still, with others in the same squares."""
    joined, square, around = _joined(rectangles), 8, _around(rectangles)
    while len(joined) > _PARTS:
        joined, square = _joined([_in_squares(each, square, around) for each in joined]), 2 * square
    return joined


def _joined(rectangles: list[UnmetPart]) -> list[UnmetPart]:
    """Those that meet at a whole edge become one."""
    across: dict[tuple[int, int], list[UnmetPart]] = defaultdict(list)
    for each in sorted(set(rectangles), key=lambda each: each.x):
        row = across[each.y, each.height]
        if row and each.x <= row[-1].x + row[-1].width:
            row[-1] = _around([row[-1], each])
        else:
            row.append(each)
    down: dict[tuple[int, int], list[UnmetPart]] = defaultdict(list)
    for each in sorted((each for row in across.values() for each in row), key=lambda each: each.y):
        column = down[each.x, each.width]
        if column and each.y <= column[-1].y + column[-1].height:
            column[-1] = _around([column[-1], each])
        else:
            column.append(each)
    return sorted((each for column in down.values() for each in column), key=lambda each: (each.y, each.x))


def _in_squares(of: UnmetPart, edge: int, within: UnmetPart) -> UnmetPart:
    """All squares of the film that it touches, so far as they are `within` that."""
    left, top = max(of.x // edge * edge, within.x), max(of.y // edge * edge, within.y)
    right = min(-(-(of.x + of.width) // edge) * edge, within.x + within.width)
    bottom = min(-(-(of.y + of.height) // edge) * edge, within.y + within.height)
    return replace(of, x=left, y=top, width=right - left, height=bottom - top)


def _touching(rectangles: list[UnmetPart]) -> list[UnmetPart]:
    groups: list[UnmetPart] = []
    for each in rectangles:
        near = [group for group in groups if _touch(group, each)]
        groups = [group for group in groups if group not in near]
        groups.append(_around([each, *near]))
    return groups


def _touch(one: UnmetPart, other: UnmetPart) -> bool:
    return (
        one.x <= other.x + other.width
        and other.x <= one.x + one.width
        and one.y <= other.y + other.height
        and other.y <= one.y + one.height
    )


def _around(all_of: Sequence[UnmetPart]) -> UnmetPart:
    left, top = min(each.x for each in all_of), min(each.y for each in all_of)
    right = max(each.x + each.width for each in all_of)
    bottom = max(each.y + each.height for each in all_of)
    return UnmetPart(left, top, right - left, bottom - top, max(each.part for each in all_of))


def _name(of: UnmetPart) -> str:
    """By its first and last pixels, from the upper left corner."""
    return f"x {_span(of.x, of.width)} y {_span(of.y, of.height)}"


def _span(first: int, length: int) -> str:
    return f"{first}" if length == 1 else f"{first} to {first + length - 1}"


def _times(part: float) -> str:
    """A part of the visible light, in words."""
    if part > _ANY:
        return "any number of times"
    return f"{part:.0%}" if part < _MANY else f"{part:.0f} times"
