"""The parameters of one plugin, read by type; parameters that are left over are reported."""

from collections.abc import Callable
from typing import TypeVar

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.elements import Element, numbers
from nocturne_scene.formats.mitsuba.read.tree import SceneTree
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.transforms import Matrix

_T = TypeVar("_T")


def vector(element: Element, default: float = 0.0) -> list[float]:
    """x, y, z as separate attributes or as one value."""
    if "value" in element.attributes:
        values = numbers(element.attributes["value"], element.place)
        if len(values) not in (1, 3):
            raise InputError.at(element.place, f"expected 1 or 3 numbers, found {len(values)}")
        return values * 3 if len(values) == 1 else values
    return [
        numbers(element.attributes[axis], element.place, 1)[0] if axis in element.attributes else default
        for axis in "xyz"
    ]


def _translate(element: Element) -> Matrix:
    return transforms.translation(vector(element))


def _scale(element: Element) -> Matrix:
    return transforms.scaling(vector(element, 1.0))


def _rotate(element: Element) -> Matrix:
    angle = numbers(element.need("angle"), element.place, 1)[0]
    try:
        return transforms.rotation(vector(element), angle)
    except ValueError as error:
        raise InputError.at(element.place, str(error)) from None


def _matrix(element: Element) -> Matrix:
    values = numbers(element.need("value"), element.place)
    matrix = transforms.IDENTITY.copy()
    if len(values) not in (9, 16):
        raise InputError.at(element.place, f"a matrix has 9 or 16 numbers, found {len(values)}")
    size = 3 if len(values) == 9 else 4
    for i, value in enumerate(values):
        matrix[i // size, i % size] = value
    if list(matrix[3]) != [0.0, 0.0, 0.0, 1.0]:
        raise InputError.at(element.place, "a matrix with perspective; expected 0 0 0 1 as its last row")
    return matrix


def _look_at(element: Element) -> Matrix:
    origin, target = (numbers(element.need(key), element.place, 3) for key in ("origin", "target"))
    up = numbers(element.attributes.get("up", "0 0 0"), element.place, 3)
    try:
        return transforms.look_at(origin, target, up)
    except ValueError as error:
        raise InputError.at(element.place, str(error)) from None


_STEPS: dict[str, Callable[[Element], Matrix]] = {
    "translate": _translate,
    "scale": _scale,
    "rotate": _rotate,
    "matrix": _matrix,
    "lookat": _look_at,
    "look_at": _look_at,
}


def transform(element: Element) -> Matrix:
    """The product of an element's steps; later ones come after."""
    matrix = transforms.IDENTITY
    for step in element.children:
        if step.tag not in _STEPS:
            raise InputError.at(step.place, f"<{step.tag}>; expected one of {', '.join(_STEPS)}")
        matrix = _STEPS[step.tag](step) @ matrix
    return matrix


class Properties:
    """Parameters by name, and plugins inside without one; each can be taken once."""

    def __init__(self, element: Element, tree: SceneTree, findings: Findings) -> None:
        self.element = element
        self.place = element.place
        self._tree = tree
        self._findings = findings
        self._named: dict[str, Element] = {}
        self._inside: list[Element] = []
        for child in element.children:
            if child.tag in _OBJECTS and not (child.name and child.tag in ("texture", "spectrum", "rgb")):
                self._inside.append(child)
            else:
                if child.name in self._named:
                    raise InputError.at(child.place, f'the parameter "{child.name[:80]}" is given twice')
                self._named[child.name] = child

    def has(self, name: str) -> bool:
        """Whether a parameter is there and not taken yet."""
        return name in self._named

    def take(self, name: str) -> Element | None:
        """Return a parameter, references resolved; None without it."""
        if name in self._named:
            return self._tree.resolve(self._named.pop(name))
        for index, child in enumerate(self._inside):
            if child.name == name:
                return self._tree.resolve(self._inside.pop(index))
        return None

    def take_all(self, tag: str) -> list[Element]:
        """Return plugins of a kind that are inside, references resolved."""
        found: list[Element] = []
        left: list[Element] = []
        for child in self._inside:
            target = self._tree.resolve(child)
            (found if target.tag == tag else left).append(child)
        self._inside = left
        return [self._tree.resolve(child) for child in found]

    def names(self) -> list[str]:
        """Of the parameters that were not taken yet."""
        return list(self._named)

    def number(self, name: str, default: _T) -> float | _T:
        """A number."""
        return self._read(name, ("float", "integer"), default, lambda text, place: numbers(text, place, 1)[0])

    def whole(self, name: str, default: _T) -> int | _T:
        """A whole number."""
        return self._read(name, ("integer",), default, _whole)

    def switch(self, name: str, default: bool) -> bool:
        """True or false."""
        return self._read(name, ("boolean",), default, _switch)

    def text(self, name: str, default: _T) -> str | _T:
        """A string."""
        element = self.take(name)
        if element is None:
            return default
        if element.tag != "string":
            raise _wrong(element, ("string",))
        return element.need("value")

    def vector(self, name: str) -> list[float] | None:
        """A point or a vector."""
        element = self.take(name)
        if element is None:
            return None
        if element.tag not in ("point", "vector"):
            raise _wrong(element, ("point", "vector"))
        return vector(element)

    def transform(self, name: str) -> Matrix:
        """A transformation; the identity without it."""
        element = self.take(name)
        if element is None:
            return transforms.IDENTITY
        if element.tag != "transform":
            raise _wrong(element, ("transform",))
        return transform(element)

    def ignore(self, *names: str) -> None:
        """Take parameters that don't change what an image converges to."""
        for name in names:
            self.take(name)

    def without_effect(self, reason: str, *names: str) -> None:
        """Take parameters, and note that they are left out without an effect."""
        for name in names:
            if self.take(name) is not None:
                self._findings.note(self.place, f'"{name}" is left out: {reason}')

    def finish(self) -> None:
        """Tell of everything that was not taken."""
        what = f"{self.element.tag} {self.element.type}".strip()
        for name in self._named:
            self._findings.lost(self.place, f'{what}: no support for the parameter "{name}"')
        for child in self._inside:
            self._findings.lost(child.place, f"{what}: no support for the <{child.tag}> inside")

    def _read(
        self, name: str, tags: tuple[str, ...], default: _T, read: Callable[[str, str], _T | float]
    ) -> "_T":
        element = self.take(name)
        if element is None:
            return default
        if element.tag not in tags:
            raise _wrong(element, tags)
        return read(element.need("value"), element.place)  # type: ignore[return-value]


_OBJECTS = frozenset(
    (
        "bsdf",
        "emitter",
        "film",
        "integrator",
        "medium",
        "phase",
        "ref",
        "rfilter",
        "sampler",
        "sensor",
        "shape",
    )
) | {"spectrum", "texture", "volume"}


def _wrong(element: Element, tags: tuple[str, ...]) -> InputError:
    return InputError.at(
        element.place, f'"{element.name[:80]}" is a <{element.tag}>; expected <{"> or <".join(tags)}>'
    )


def _whole(text: str, place: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise InputError.at(place, f'expected a whole number, found "{text[:40]}"') from None


def _switch(text: str, place: str) -> bool:
    """In letters of either case, as Mitsuba reads it: Python writes True."""
    word = text.strip().lower()
    if word not in ("true", "false"):
        raise InputError.at(place, f'expected true or false, found "{text[:40]}"')
    return word == "true"
