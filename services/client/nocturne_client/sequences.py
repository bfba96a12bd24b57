"""Many renders of one submission: a folder of documents, the frames of a film, variants of a scene."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any

from nocturne_client.changes import parse_change
from nocturne_client.errors import NocturneClientError

_FRAMES = re.compile(r"(\d+)-(\d+)")
_NUMBER = r"[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?"
_FROM_TO = re.compile(rf"({_NUMBER})\.\.({_NUMBER})")

MAX_MEMBERS = 10_000


@dataclass(frozen=True)
class Member:
    """One render of a group."""

    scene: Path
    name: str
    """What tells it from the others; empty where there are none."""
    changes: Mapping[str, Any] = field(default_factory=dict)


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
            _in_frame(changes, number, numbers) | dict(variant),
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


def _values(text: str) -> list[tuple[str, Any]]:
    """`place=1,2` or `place=[0,0],[1,1]`; what is no JSON is words between commas."""
    place, _, values = text.partition("=")
    try:
        return [(parse_change(text)[0], value) for value in json.loads(f"[{values}]")]
    except ValueError:
        return [parse_change(f"{place}={value.strip()}") for value in values.split(",")]


def _in_frame(changes: Mapping[str, Any], number: int, numbers: Sequence[int]) -> dict[str, Any]:
    if len(numbers) == 1:
        return dict(changes)
    part = (number - numbers[0]) / (numbers[-1] - numbers[0])
    return {place: _between(value, part) for place, value in changes.items()}


def _between(value: Any, part: float) -> Any:
    match = _FROM_TO.fullmatch(value.strip()) if isinstance(value, str) else None
    if match is None:
        return value
    start, end = float(match[1]), float(match[2])
    return start + part * (end - start)


def _words(scene: Path | None, variant: Sequence[tuple[str, Any]], frame: str) -> Iterator[str]:
    if scene is not None:
        yield scene.stem
    for place, value in variant:
        yield f"{place.rpartition('.')[2]}={value}"
    if frame:
        yield frame
