"""XML as a tree, with defaults, paths, includes and references resolved as Mitsuba does."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers.expat import ExpatError, ParserCreate, XMLParserType

from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.scene_files import TEXT_BYTES, SceneFiles, read_bytes

# Elements of a scene, included files each time they are; and how deep they and the files may nest.
_MAX_ELEMENTS = 1_000_000
_MAX_DEPTH = 64
_MAX_INCLUDES = 16

_PARAMETER = re.compile(r"\$(\w+)")


@dataclass
class Element:
    """One XML element; `place` names file and line."""

    tag: str
    attributes: dict[str, str]
    place: str
    children: list["Element"] = field(default_factory=list)

    @property
    def type(self) -> str:
        """The plugin's name."""
        return self.attributes.get("type", "")

    @property
    def name(self) -> str:
        """The parameter that it is for."""
        return self.attributes.get("name", "")

    @property
    def id(self) -> str:
        """What references call it."""
        return self.attributes.get("id", "")

    def need(self, attribute: str) -> str:
        """Return an attribute; InputError without it."""
        if attribute not in self.attributes:
            raise InputError.at(self.place, f'<{self.tag}> needs the attribute "{attribute}"')
        return self.attributes[attribute]


class _Builder:
    """Builds elements of what the parser tells, and remembers their lines."""

    def __init__(self, parser: XMLParserType, shown: str) -> None:
        self.root: Element | None = None
        self._shown = shown
        self._parser = parser
        self._open: list[Element] = []
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._text
        # Entities are declared in a document type, and nowhere else: without one, none grows or names a file.
        parser.StartDoctypeDeclHandler = self._refuse

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) >= _MAX_DEPTH:
            raise InputError.at(self._place(), f"elements are nested more than {_MAX_DEPTH} deep")
        element = Element(tag, attributes, self._place())
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _text(self, text: str) -> None:
        if text.strip():
            raise InputError.at(self._place(), f'text "{text.strip()[:40]}" between elements')

    def _refuse(self, *_: object) -> None:
        raise InputError.at(self._shown, "declares a document type or entities, which scenes have no need of")

    def _place(self) -> str:
        return f"{self._shown}:{self._parser.CurrentLineNumber}"


def parse_xml(content: bytes, shown: str) -> Element:
    """Return the root of a file. Raises InputError for what is no XML or may be harmful."""
    parser = ParserCreate()
    builder = _Builder(parser, shown)
    try:
        parser.Parse(content, True)
    except ExpatError as error:
        raise InputError.at(shown, f"is no XML: {str(error)[:200]}") from None
    except (ValueError, LookupError) as error:
        raise InputError.at(shown, f"has an encoding that can't be read: {str(error)[:200]}") from None
    if builder.root is None:
        raise InputError.at(shown, "is empty")
    return builder.root


class SceneTree:
    """The elements of a scene, and how to find files and other elements."""

    def __init__(self, files: SceneFiles, file: Path, parameters: Mapping[str, str]) -> None:
        """Read `file` and all that it includes; `parameters` replace its defaults. Raises InputError."""
        self.files = files
        self.folders = [file.parent]
        self.by_id: dict[str, Element] = {}
        self._parameters = dict(parameters)
        self._count = 0
        self.elements = self._read(file, ())

    def file(self, element: Element, name: str) -> Path:
        """Return a file that an element names."""
        return self.files.find(name, self.folders, element.place)

    def resolve(self, element: Element) -> Element:
        """Return what a reference refers to; other elements are themselves."""
        if element.tag != "ref":
            return element
        wanted = element.need("id")
        if wanted not in self.by_id:
            known = ", ".join(sorted(self.by_id)[:20]) or "none"
            raise InputError.at(element.place, f'nothing has the id "{wanted[:80]}"; known: {known}')
        return self.by_id[wanted]

    def _read(self, file: Path, opened: tuple[Path, ...]) -> list[Element]:
        shown = self.files.shown(file)
        if file in opened:
            raise InputError.at(shown, "includes itself")
        if len(opened) >= _MAX_INCLUDES:
            raise InputError.at(shown, f"files are included more than {_MAX_INCLUDES} deep")
        root = parse_xml(read_bytes(file, TEXT_BYTES, shown), shown)
        version = root.attributes.get("version", "")
        if root.tag == "scene" and re.match(r"0\.", version):
            raise InputError.at(root.place, f"version {version} is of Mitsuba 0.x; expected 2.0 or later")
        wrapped = root.children if root.tag == "scene" else [root]
        return list(self._expanded(wrapped, (*opened, file)))

    def _expanded(self, elements: list[Element], opened: tuple[Path, ...]) -> Iterator[Element]:
        for element in elements:
            self._count += 1
            if self._count > _MAX_ELEMENTS:
                raise InputError.at(element.place, f"more than {_MAX_ELEMENTS:,} elements")
            if self._is_unset_count(element):
                continue
            for key, value in element.attributes.items():
                element.attributes[key] = self._substituted(value, element.place)
            match element.tag:
                case "default":
                    self._parameters.setdefault(element.need("name"), element.need("value"))
                case "path":
                    self.folders.insert(0, self._folder(element, opened))
                case "include":
                    folders = [*self.folders, opened[-1].parent]
                    yield from self._read(
                        self.files.find(element.need("filename"), folders, element.place), opened
                    )
                case "alias":
                    target = self.resolve(Element("ref", {"id": element.need("id")}, element.place))
                    self._remember(element.need("as"), target)
                case _:
                    element.children = list(self._expanded(element.children, opened))
                    if element.id and element.tag != "ref":
                        self._remember(element.id, element)
                    yield element

    def _folder(self, element: Element, opened: tuple[Path, ...]) -> Path:
        """The folder of a <path>: beside its file, or else beside one that includes that."""
        name = element.need("value")
        for base in opened[::-1]:
            if (base.parent / name.replace("\\", "/")).is_dir():
                return self.files.folder(name, base.parent, element.place)
        return self.files.folder(name, opened[-1].parent, element.place)

    def _remember(self, name: str, element: Element) -> None:
        if name in self.by_id and self.by_id[name] is not element:
            raise InputError.at(element.place, f'the id "{name[:80]}" is used twice')
        self.by_id[name] = element

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
