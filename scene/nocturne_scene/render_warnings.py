"""Warnings for readers of a render, in addition to its error: of its scene, and of parts of its image.

Compiled scene, schedule, data folder, API and client have the same fields; an EXR has them as lines.
"""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

from nocturne.v1 import warning_pb2


class WarningKind(StrEnum):
    """What a warning is about."""

    SCENE = "scene"
    """The document has a probable mistake."""
    LAYERS = "layers"
    """They could not be made."""
    MISSING_LIGHT = "missing_light"
    """So much of the image's mean may be missing."""
    MISSING_IN_PARTS = "missing_in_parts"
    """Light may be missing in parts of the image."""
    FAULT = "fault"
    """Of the program."""


@dataclass(frozen=True)
class UnmetPart:
    """Pixels [x, x + width) times [y, y + height), from the upper left corner, in which light may be missing
    that no error shows."""

    x: int
    y: int
    width: int
    height: int
    part: float
    """The most that may be missing, in parts of the light there."""

    @property
    def pixels(self) -> tuple[slice, slice]:
        """Rows and columns."""
        return slice(self.y, self.y + self.height), slice(self.x, self.x + self.width)


@dataclass(frozen=True)
class RenderWarning:
    """A sentence; and the parts of the image that it is about, where it is about parts."""

    kind: WarningKind
    sentence: str
    parts: tuple[UnmetPart, ...] = ()

    def message(self) -> warning_pb2.RenderWarning:
        """As the contracts have it."""
        return warning_pb2.RenderWarning(
            kind=self.kind.value,
            sentence=self.sentence,
            parts=[warning_pb2.UnmetPart(**asdict(part)) for part in self.parts],
        )

    def to_json(self) -> dict[str, Any]:
        """As the data folder keeps it."""
        return asdict(self)

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> "RenderWarning":
        parts = tuple(UnmetPart(**part) for part in value["parts"])
        return cls(WarningKind(value["kind"]), value["sentence"], parts)


def of_scene(sentences: Iterable[str]) -> list[RenderWarning]:
    """Warnings of probable mistakes."""
    return [RenderWarning(WarningKind.SCENE, sentence) for sentence in sentences]


def from_messages(messages: Iterable[warning_pb2.RenderWarning]) -> tuple[RenderWarning, ...]:
    """Those of a compiled scene, or a schedule."""
    return tuple(
        RenderWarning(
            WarningKind(each.kind),
            each.sentence,
            tuple(UnmetPart(part.x, part.y, part.width, part.height, part.part) for part in each.parts),
        )
        for each in messages
    )


def header_lines(warnings: Sequence[RenderWarning]) -> dict[str, str]:
    """Attributes of an image's header, as nocturne-trace spells them; none where there is nothing to say."""
    lines = {
        "nocturne:warnings": "\n".join(each.sentence for each in warnings),
        "nocturne:unmetParts": "\n".join(
            f"{part.x} {part.y} {part.width} {part.height} {part.part:.3g}"
            for each in warnings
            for part in each.parts
        ),
    }
    return {name: text for name, text in lines.items() if text}
