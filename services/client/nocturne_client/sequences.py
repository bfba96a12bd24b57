"""Many renders of one submission: a folder of documents, the frames of a film, variants of a scene."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from nocturne_client.changes import parse_change
from nocturne_client.errors import NocturneClientError

_FRAMES = re.compile(r"(\d+)-(\d+)")
_NUMBER = r"[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?"
_FROM_TO = re.compile(rf"({_NUMBER})\.\.({_NUMBER})")

MAX_MEMBERS = 10_000

# Characters of a value in a render's name.
_MAX_SHOWN = 40


@dataclass(frozen=True)
class Member:
    """One render of a group."""

    scene: Path
    name: str
    """What tells it from the others; empty where there are none."""
    changes: Mapping[str, Any] = field(default_factory=dict)


class _Variant(NamedTuple):
    """One value of a place that is varied, and its name."""

    place: str
    value: Any
    shown: str


def members_of(scene: Path, changes: Mapping[str, Any], frames: str, varied: Sequence[str]) -> list[Member]:
    """Every document of a folder, or the one, in every variant, in every frame. Raises NocturneClientError.

    `varied`: `place=one,another`. In frames a change to `0..2.5` goes evenly from the first to the last.
    """
    scenes = _scenes(scene)
    numbers = _numbers(frames)
    variants = [_values(text) for text in varied]
    count = len(scenes) * len(numbers)
    for variant in variants:
        count *= len(variant)
    if count > MAX_MEMBERS:
        raise NocturneClientError(f"{count} renders are too many for one group; at most {MAX_MEMBERS}")
    found = product(scenes, product(*variants), numbers)
    digits = len(str(numbers[-1]))
    return [
        Member(
            each,
            " ".join(_words(each if len(scenes) > 1 else None, variant, frames and f"{number:0{digits}}")),
            (_in_frame(changes, number, numbers) if frames else dict(changes))
            | {one.place: one.value for one in variant},
        )
        for each, variant, number in found
    ]


def _scenes(scene: Path) -> list[Path]:
    if not scene.is_dir():
        return [scene]
    found = sorted(scene.glob("*.json"))
    if not found:
        raise NocturneClientError(f"{scene} has no scene documents (*.json)")
    return found


def _numbers(frames: str) -> list[int]:
    if not frames:
        return [0]
    match = _FRAMES.fullmatch(frames.strip())
    if match is None or int(match[2]) < int(match[1]):
        raise NocturneClientError(f"--frames {frames!r}: expected FIRST-LAST, such as 1-240")
    if int(match[2]) - int(match[1]) >= MAX_MEMBERS:
        raise NocturneClientError(f"--frames {frames!r}: at most {MAX_MEMBERS} frames")
    return list(range(int(match[1]), int(match[2]) + 1))


def _values(text: str) -> list[_Variant]:
    """`place=1,2` or `place=[0,0],[1,1]`; text that is no JSON is words between commas."""
    place, _, values = text.partition("=")
    try:
        found = [(parse_change(text)[0], value) for value in json.loads(f"[{values}]")]
    except ValueError:
        found = [parse_change(f"{place}={value.strip()}") for value in values.split(",")]
    shown = [_shown(value) for _, value in found]
    return [
        _Variant(at, value, f"{word} {number}" if shown.count(word) > 1 else word)
        for number, ((at, value), word) in enumerate(zip(found, shown, strict=True), 1)
    ]


def _shown(value: Any) -> str:
    """A value in a render's name: of a part of a scene its name or its type, of much the beginning."""
    if isinstance(value, dict):
        value = next((value[key] for key in ("name", "type") if isinstance(value.get(key), str)), value)
    text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
    return text if len(text) <= _MAX_SHOWN else f"{text[: _MAX_SHOWN - 1]}\u2026"


def _in_frame(changes: Mapping[str, Any], number: int, numbers: Sequence[int]) -> dict[str, Any]:
    # Of one frame that is the first value.
    part = (number - numbers[0]) / max(numbers[-1] - numbers[0], 1)
    return {place: _between(value, part) for place, value in changes.items()}


def _between(value: Any, part: float) -> Any:
    match = _FROM_TO.fullmatch(value.strip()) if isinstance(value, str) else None
    if match is None:
        return value
    start, end = float(match[1]), float(match[2])
    return start + part * (end - start)


def _words(scene: Path | None, variant: Sequence[_Variant], frame: str) -> Iterator[str]:
    if scene is not None:
        yield scene.stem
    for one in variant:
        yield f"{one.place.rpartition('.')[2]}={one.shown}"
    if frame:
        yield frame
