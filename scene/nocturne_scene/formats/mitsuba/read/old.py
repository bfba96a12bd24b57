"""A plugin of Mitsuba 0.x that is being put into the words of Mitsuba 3."""

from collections.abc import Callable
from dataclasses import dataclass

from nocturne_scene.formats.mitsuba.read.elements import Element, numbers
from nocturne_scene.formats.mitsuba.read.old_values import made, said
from nocturne_scene.formats.reading.findings import Findings


@dataclass(frozen=True)
class Old:
    """A plugin that is being upgraded; its parameters have their new names already."""

    element: Element
    version: tuple[int, ...]
    findings: Findings
    resolve: Callable[[Element], Element]

    def find(self, name: str) -> Element | None:
        """Return a parameter."""
        return next((child for child in self.element.children if child.name == name), None)

    def take(self, name: str) -> Element | None:
        """Return a parameter and remove it."""
        found = self.find(name)
        if found is not None:
            self.element.children.remove(found)
        return found

    def number(self, name: str, default: float) -> float:
        """Take a number."""
        found = self.take(name)
        return default if found is None else numbers(found.need("value"), found.place, 1)[0]

    def text(self, name: str, default: str) -> str:
        """Take a string, in small letters as 0.x compares it."""
        found = self.take(name)
        return default if found is None else found.need("value").lower()

    def drop(self, *names: str) -> None:
        """Remove parameters that don't change what an image converges to."""
        if names:
            self.element.children = [child for child in self.element.children if child.name not in names]

    def add(self, tag: str, name: str, value: object) -> None:
        """Add a parameter."""
        self.element.children.append(said(tag, name, value, self.element.place))

    def set(self, tag: str, name: str, value: object) -> None:
        """Add a parameter that takes the place of one by the same name."""
        self.take(name)
        self.add(tag, name, value)

    def name_nested(self, tag: str, name: str) -> None:
        """Give a nested plugin, or a reference to one, the name that it has in Mitsuba 3."""
        for child in self.element.children:
            if self.kind(child) == tag:
                child.attributes["name"] = name
                return

    def kind(self, child: Element) -> str:
        """The tag of a nested plugin, or of the one that a reference refers to."""
        return self.resolve(child).tag

    def note(self, message: str) -> None:
        """Note a different form: once, as 0.x scenes say the same hundreds of times."""
        self.findings.note("", message)

    def lose(self, message: str) -> None:
        """Report a part without a counterpart."""
        self.findings.lost(self.element.place, message)

    def fix_handedness(self) -> None:
        """Cameras of before 0.4 saw x to the other side, and the smaller side by their fov: 0.4.0.xsl."""
        smaller = self.text("mapSmallerSide", "true")
        if self.element.type == "perspective":
            self.add("string", "fov_axis", "larger" if smaller == "false" else "smaller")
        for child in self.element.children:
            if child.tag == "transform" and child.name == "toWorld":
                child.children.insert(0, made("scale", child.place, x="-1"))
