"""The elements of a scene, with defaults, paths, includes and references resolved as Mitsuba does."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.elements import Element, Packed, parse_xml
from nocturne_scene.formats.mitsuba.read.upgrade import NEW, Version, upgrade, version_of
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_files import SceneFiles

# Elements of a scene, included files each time they are, and those of them that stay in memory; and how deep
# files may include others.
_MAX_ELEMENTS = 20_000_000
_MAX_KEPT = 1_000_000
_MAX_INCLUDES = 16

# Parameters of a plugin.
_VALUES = ("boolean", "float", "integer", "string")

_PARAMETER = re.compile(r"\$(\w+)")
_Opened = tuple[Path, ...]


class SceneTree:
    """The elements of a scene, and how to find files and other elements.

    Shapes lie in a temporary file, as there may be a million: those of the scene, and those of its groups.
    Only elements that others may refer to stay in memory.
    """

    def __init__(
        self, files: SceneFiles, file: Path, parameters: Mapping[str, str], findings: Findings
    ) -> None:
        """Read `file` and all that it includes; `parameters` replace its defaults. Raises InputError.

        Files of Mitsuba 0.x are upgraded; `findings` note the changes.
        """
        self.files = files
        self._findings = findings
        self._versions: dict[Path, Version] = {}
        self.folders = [file.parent]
        self._parameters = dict(parameters)
        self._by_id: dict[str, Element | int] = {}
        self._packed = Packed()
        self._elements: list[Element | int] = []
        self._count = 0
        self._kept = 0
        self._numbered = 0
        self._read(file, (), self._elements)

    def elements(self, tag: str) -> Iterator[Element]:
        """Those of a kind, in the order of the files."""
        for element in self._elements:
            if isinstance(element, int):
                if tag == "shape":
                    yield self._packed[element]
            elif element.tag == tag:
                yield element

    def other_elements(self, *tags: str) -> Iterator[Element]:
        """Those of no kind of these."""
        found = (element for element in self._elements if isinstance(element, Element))
        yield from (element for element in found if element.tag not in tags)

    def members(self, group: Element) -> Iterator[Element]:
        """Shapes of a group that are no children of its element."""
        for index in group.packed:
            yield self._packed[index]

    def file(self, element: Element, name: str) -> Path:
        """Return a file that an element names."""
        return self.files.find(name, self.folders, element.place)

    def resolve(self, element: Element) -> Element:
        """Return what a reference refers to; other elements are themselves."""
        if element.tag != "ref":
            return element
        found = self._referred(element)
        return self._packed[found] if isinstance(found, int) else found

    def _referred(self, reference: Element) -> Element | int:
        wanted = reference.need("id")
        if wanted not in self._by_id:
            known = ", ".join(sorted(self._by_id)[:20]) or "none"
            raise InputError.at(reference.place, f'nothing has the id "{wanted[:80]}"; known: {known}')
        return self._by_id[wanted]

    def _read(self, file: Path, opened: _Opened, into: list[Element | int]) -> None:
        """Put the elements of a file where they belong."""
        shown = self.files.shown(file)
        if file in opened:
            raise InputError.at(shown, "includes itself")
        if len(opened) >= _MAX_INCLUDES:
            raise InputError.at(shown, f"files are included more than {_MAX_INCLUDES} deep")
        inside = (*opened, file)
        around_file = self._versions[opened[-1]] if opened else NEW

        def part(element: Element, around: list[Element]) -> bool:
            if file not in self._versions:
                self._versions[file] = version_of(around[0] if around else element, around_file)
            is_root = not around and element.tag != "scene"
            if is_root or (len(around) == 1 and around[0].tag == "scene"):
                self._take(element, inside, into)
                return True
            if len(around) == 2 and around[0].tag == "scene" and _is_member(element, around[1]):
                found: list[Element | int] = []
                self._take(element, inside, found)
                around[1].packed += [each for each in found if isinstance(each, int)]
                around[1].children += [each for each in found if isinstance(each, Element)]
                return True
            return False

        parse_xml(file, shown, part)

    def _take(self, element: Element, opened: _Opened, into: list[Element | int]) -> None:
        if element.tag == "include":
            self._counted(element)
            self._substitute(element)
            self._read(self._included(element, opened), opened, into)
            return
        kept, names = self._kept, len(self._by_id)
        for each in self._expanded([element], opened):
            if each.tag in _VALUES and self._versions[opened[-1]] < NEW:
                # Mitsuba 0.x warns of values of a whole scene, and reads none.
                self._findings.note(each.place, f'"{each.name}" is of no plugin; left out')
                continue
            # A named element inside of a shape may be referred to.
            own = 1 if each.id else 0
            if each.tag != "shape" or each.type == "shapegroup" or len(self._by_id) > names + own:
                into.append(each)
                continue
            index = self._packed.add(each)
            if each.id:
                self._by_id[each.id] = index
            self._kept = kept
            into.append(index)

    def _expanded(self, elements: list[Element], opened: _Opened) -> Iterator[Element]:
        for element in elements:
            if element.number >= 0:  # a member of a group, taken before
                yield element
                continue
            self._counted(element)
            if self._is_unset_count(element):
                continue
            self._substitute(element)
            match element.tag:
                case "default":
                    self._parameters.setdefault(element.need("name"), element.need("value"))
                case "path":
                    self.folders.insert(0, self._folder(element, opened))
                case "include":
                    found: list[Element | int] = []
                    self._read(self._included(element, opened), opened, found)
                    yield from (self._packed[each] if isinstance(each, int) else each for each in found)
                case "alias":
                    target = self._referred(Element("ref", {"id": element.need("id")}, element.place))
                    self._remember(element.need("as"), target, element.place)
                case _:
                    element.children = list(self._expanded(element.children, opened))
                    upgrade(element, self._versions[opened[-1]], self._findings, self._target)
                    self._number(element)
                    if element.id and element.tag != "ref":
                        self._remember(element.id, element, element.place)
                    yield element

    def _target(self, reference: Element) -> Element:
        """What a reference refers to, or itself where that is not known yet."""
        return self.resolve(reference) if reference.attributes.get("id") in self._by_id else reference

    def _number(self, element: Element) -> None:
        """Number an element, and those inside that came by an upgrade."""
        for child in element.children:
            if child.number < 0:
                self._number(child)
        element.number = self._numbered
        self._numbered += 1

    def _counted(self, element: Element) -> None:
        self._count += 1
        self._kept += 1
        if self._count > _MAX_ELEMENTS:
            raise InputError.at(element.place, f"more than {_MAX_ELEMENTS:,} elements")
        if self._kept > _MAX_KEPT:
            raise InputError.at(element.place, f"more than {_MAX_KEPT:,} elements besides shapes")

    def _substitute(self, element: Element) -> None:
        for key, value in element.attributes.items():
            if "$" in value:
                element.attributes[key] = self._substituted(value, element.place)

    def _included(self, element: Element, opened: _Opened) -> Path:
        folders = [*self.folders, opened[-1].parent]
        return self.files.find(element.need("filename"), folders, element.place)

    def _folder(self, element: Element, opened: tuple[Path, ...]) -> Path:
        """The folder of a <path>: next to its file, or else next to one that includes that."""
        name = element.need("value")
        for base in opened[::-1]:
            if (base.parent / name.replace("\\", "/")).is_dir():
                return self.files.folder(name, base.parent, element.place)
        return self.files.folder(name, opened[-1].parent, element.place)

    def _remember(self, name: str, element: Element | int, place: str) -> None:
        if name in self._by_id and self._by_id[name] is not element:
            raise InputError.at(place, f'the id "{name[:80]}" is used twice')
        self._by_id[name] = element

    def _is_unset_count(self, element: Element) -> bool:
        """Whether it is a number of samples that has no value: whoever renders the scene chooses that."""
        return element.name == "sample_count" and any(
            name not in self._parameters for name in _PARAMETER.findall(element.attributes.get("value", ""))
        )

    def _substituted(self, value: str, place: str) -> str:
        def found(match: re.Match[str]) -> str:
            if match[1] not in self._parameters:
                raise InputError.at(
                    place,
                    f'the parameter "{match[1][:80]}" has no value; give one with -D {match[1][:80]}=VALUE',
                )
            return self._parameters[match[1]]

        return _PARAMETER.sub(found, value)


def _is_member(element: Element, around: Element) -> bool:
    return element.tag == "shape" and around.tag == "shape" and around.type == "shapegroup"
