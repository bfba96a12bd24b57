"""Following the directives of a pbrt scene through its files, and the state that they change."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read.context import Context, State
from nocturne_scene.formats.pbrt.read.parameters import Parameter, Parameters, Stream
from nocturne_scene.formats.pbrt.read.tokens import read_lines, tokens
from nocturne_scene.formats.pbrt.read.upgrade import upgrade
from nocturne_scene.formats.reading.findings import TooLarge
from nocturne_scene.formats.reading.transforms import Matrix

# Directives of former versions.
_OLD = ("Volume", "SearchPath")
_MAX_INCLUDES = 16
# Directives of a scene, those of included files each time.
_MAX_DIRECTIVES = 20_000_000
# Of shapes in objects, which are kept until instances need them.
_MAX_RECORDED = 200_000


@dataclass
class RecordedShape:
    """A shape of an object, to be made where instances need it."""

    kind: str
    given: list[Parameter]
    place: str
    state: State


@dataclass
class Reader:
    """Follows the directives of one scene, each by its function in `directives`."""

    context: Context
    directives: "Mapping[str, Directive]"
    saved: list[State] = field(default_factory=list)
    objects: dict[str, list[RecordedShape]] = field(default_factory=dict)
    groups: dict[str, str] = field(default_factory=dict)
    recording: str | None = None
    in_world: bool = False
    ended: bool = False
    count: int = 0
    recorded: int = 0

    def read(self, file: Path, opened: tuple[Path, ...]) -> None:
        """All directives of a file and of those that it includes."""
        shown = self.context.files.shown(file)
        if file in opened:
            raise InputError.at(shown, "includes itself")
        if len(opened) >= _MAX_INCLUDES:
            raise InputError.at(shown, f"files are included more than {_MAX_INCLUDES} deep")
        stream = Stream(tokens(read_lines(file, shown), shown))
        while stream.ahead is not None and not self.ended:
            token = stream.take(shown)
            self.count += 1
            if self.count > _MAX_DIRECTIVES:
                raise InputError.at(token.place, f"more than {_MAX_DIRECTIVES:,} directives")
            if token.kind != "word" or (
                token.text not in self.directives and token.text not in ("Include", "Import")
            ):
                old = " of pbrt-v4 or pbrt-v3: the file is of pbrt-v2 or before"
                hint = old if token.text in _OLD else ""
                raise InputError.at(token.place, f'no directive "{token.text[:40]}"{hint}')
            if token.text in ("Include", "Import"):
                name = stream.string(token.place)
                self.read(self.context.file(name, token.place), (*opened, file))
            else:
                self.directives[token.text](self, stream, token.place)

    def record(self, shape: RecordedShape) -> None:
        """Keep a shape of the object of now. Raises TooLarge."""
        self.recorded += 1
        if self.recorded > _MAX_RECORDED:
            raise TooLarge(f"more than {_MAX_RECORDED:,} shapes in objects", shape.place)
        self.objects[self.recording or ""].append(shape)

    def apply(self, matrix: Matrix) -> None:
        """Let coordinates from here on be inside of the current ones."""
        self.context.state.transform = self.context.state.transform @ matrix

    def plugin(self, target: str, stream: Stream, place: str) -> tuple[str, Parameters]:
        """A plugin's name and its parameters, the defaults of `Attribute` first."""
        kind = stream.string(place)
        given = [*self.context.state.defaults.get(target, []), *stream.parameters(place)]
        kind, given = upgrade(self.context, target, kind, given, place)
        return kind, self.context.parameters(f"{target} {kind}".strip(), place, given)


Directive = Callable[[Reader, Stream, str], None]
