"""Kernels inside kernels and groups inside groups: no circles, bounded depth, no boundary with one side."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from nocturne_scene.document import bounds
from nocturne_scene.document.kernels import Dielectric, Kernel, TwoSided, inner_kernels
from nocturne_scene.document.model import SceneDocument, all_surfaces
from nocturne_scene.document.problems import path
from nocturne_scene.document.surfaces import Instance
from nocturne_scene.errors import Problem


def kernel_graph_problems(document: SceneDocument) -> Iterator[Problem]:
    """Yield a circle of kernels, kernels that are too deep, and dielectrics under two_sided."""
    order, circle = _innermost_first(document.kernels, lambda name: _names(document.kernels[name]))
    if circle:
        yield _circle_problem("kernels", circle)
        return
    named: dict[str, _Inside] = {}
    for name in order:
        named[name] = _inside(document.kernels[name], named)
    for place, kernel in _kernels(document):
        depth = _inside(kernel, named).depth
        if depth > bounds.KERNEL_DEPTH:
            words = f"kernels inside kernels {depth} deep, names followed; at most {bounds.KERNEL_DEPTH}"
            yield Problem(place, words)
        else:
            yield from _one_sided_boundaries(kernel, named, place)


def group_problems(document: SceneDocument) -> Iterator[Problem]:
    """Yield a circle of groups, and groups that are too deep."""

    def inner(name: str) -> list[str]:
        members = document.groups[name]
        return [member.group for member in members if isinstance(member, Instance)]

    order, circle = _innermost_first(document.groups, inner)
    if circle:
        yield _circle_problem("groups", circle)
        return
    depths: dict[str, int] = {}
    for name in order:
        depths[name] = 1 + max((depths[other] for other in inner(name)), default=0)
        if depths[name] == bounds.GROUP_DEPTH + 1:
            yield Problem(path(("groups", name)), f"groups in groups more than {bounds.GROUP_DEPTH} deep")


class _Inside(NamedTuple):
    """The contents of a kernel, names followed."""

    depth: int
    dielectric: bool


def _inside(kernel: str | Kernel, named: Mapping[str, _Inside]) -> _Inside:
    if isinstance(kernel, str):
        return named[kernel]
    inner = [_inside(other, named) for _, other in inner_kernels(kernel)]
    return _Inside(
        1 + max((other.depth for other in inner), default=0),
        isinstance(kernel, Dielectric) or any(other.dielectric for other in inner),
    )


def _one_sided_boundaries(kernel: Kernel, named: Mapping[str, _Inside], place: str) -> Iterator[Problem]:
    for field, inner in inner_kernels(kernel):
        if isinstance(kernel, TwoSided) and _inside(inner, named).dielectric:
            yield Problem(
                f"{place}.{field}",
                "is a dielectric, which is the boundary of a body and has both sides; use it without "
                "two_sided, or thin_pane here",
            )
        elif not isinstance(inner, str):
            yield from _one_sided_boundaries(inner, named, f"{place}.{field}")


def _kernels(document: SceneDocument) -> Iterator[tuple[str, Kernel]]:
    for name, kernel in document.kernels.items():
        yield path(("kernels", name)), kernel
    for place, surface in all_surfaces(document):
        if surface.kernel is not None and not isinstance(surface.kernel, str):
            yield f"{place}.kernel", surface.kernel


def _names(kernel: Kernel) -> list[str]:
    """Names that a kernel uses, also in kernels that stand inside it."""
    found = []
    for _, inner in inner_kernels(kernel):
        found += [inner] if isinstance(inner, str) else _names(inner)
    return found


def _circle_problem(collection: str, circle: Sequence[str]) -> Problem:
    shown = " -> ".join(f'"{name}"' for name in circle[: bounds.CHOICES_SHOWN])
    return Problem(path((collection, circle[0])), f"contains itself: {shown}")


def _innermost_first(names: Iterable[str], inner: Callable[[str], list[str]]) -> tuple[list[str], list[str]]:
    """Return the names so that what one uses comes before it, and a circle if there is one, else nothing.

    Without recursion, as chains of names may be long.
    """
    order: dict[str, None] = {}
    for start in names:
        trail: dict[str, Iterator[str]] = {}
        following: str | None = start
        while following is not None or trail:
            if following in trail:
                steps = list(trail)
                return list(order), [*steps[steps.index(following) :], following]
            if following is not None and following not in order:
                trail[following] = iter(inner(following))
            following = next(next(reversed(trail.values())), None) if trail else None
            if following is None and trail:
                order[trail.popitem()[0]] = None
    return list(order), []
