"""The renders that a group request asks for: its scene in every variation and frame."""

import hashlib
import json
import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from nocturne_scene.document.changes import changed
from nocturne_scene.errors import InputError, Problem

from nocturne_api.limits import GROUP_BYTES, GROUP_RENDERS, MEBIBYTE
from nocturne_api.models.render_requests import CreateGroupRequest, CreateRenderRequest, Variation

_NUMBER = r"[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?"
_FROM_TO = re.compile(rf"({_NUMBER})\.\.({_NUMBER})")

# Characters of a value in a render's name.
_MAX_SHOWN = 40


@dataclass(frozen=True, slots=True)
class Member:
    """One render of a group, before its document is made."""

    name: str
    """What tells it from the others; empty where there are none."""
    request_id: str
    changes: Mapping[str, Any]

    def request(self, asked: CreateRenderRequest) -> CreateRenderRequest:
        """Its request. Raises InputError for a place that the scene does not have."""
        scene = changed(asked.scene, self.changes) if self.changes else asked.scene
        name = f"{asked.name} {self.name}".strip() if self.name else asked.name
        return asked.model_copy(update={"request_id": self.request_id, "name": name, "scene": scene})

    def located(self, error: InputError) -> InputError:
        """The same problems, which name this render, too."""
        if not self.name:
            return error
        return InputError(Problem(f"{self.name}: {each.place}", each.message) for each in error.problems)


class Members:
    """The members of a group, each made when it is asked for."""

    def __init__(self, asked: CreateGroupRequest) -> None:
        """Raises InputError where they or their documents would be too many."""
        frames = asked.frames
        self._frames = range(frames.first, frames.last + 1) if frames else range(1)
        self._count = len(self._frames) * math.prod(len(each.values) for each in asked.varied)
        if self._count == 0:
            raise InputError.at("$.frames", "ends before it begins")
        if self._count > GROUP_RENDERS:
            raise InputError.at(
                "$", f"asks for {self._count} renders, which are too many; at most {GROUP_RENDERS}"
            )
        mebibytes = self._count * _largest_document(asked) // MEBIBYTE if self._count > 1 else 0
        if mebibytes > GROUP_BYTES // MEBIBYTE:
            raise InputError.at(
                "$.scene",
                f"{self._count} documents have {mebibytes} MiB; at most {GROUP_BYTES // MEBIBYTE} are taken "
                "at once. Put meshes into files beside it, or add to the group by further requests",
            )
        own = asked.scene.get("name")
        name = asked.name or (own if isinstance(own, str) else "")
        group = asked.group
        if self._count > 1 and not group:
            group = f"{name or 'group'} {hashlib.sha256(asked.request_id.encode()).hexdigest()[:6]}"
        self.asked = asked.model_copy(update={"name": name, "group": group})
        """The request, with the names that it leaves to the service."""

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[Member]:
        asked, frames = self.asked, self._frames
        variants = product(*(_named_values(each) for each in asked.varied))
        digits = len(str(frames[-1]))
        for index, (variant, frame) in enumerate(product(variants, frames)):
            words = [f"{place.rpartition('.')[2]}={shown}" for place, shown, _ in variant]
            changes = asked.changes
            if asked.frames is not None:
                words.append(f"{frame:0{digits}}")
                # Of one frame that is the first value.
                part = (frame - frames[0]) / max(len(frames) - 1, 1)
                changes = {place: _between(value, part) for place, value in changes.items()}
            yield Member(
                " ".join(words),
                asked.request_id if len(self) == 1 else f"{asked.request_id}/{index}",
                changes | {place: value for place, _, value in variant},
            )


def _largest_document(asked: CreateGroupRequest) -> int:
    """Bytes of a member's document, at most."""
    varied = (max(len(json.dumps(value)) for value in each.values) for each in asked.varied)
    return len(json.dumps(asked.scene)) + len(json.dumps(asked.changes)) + sum(varied)


def _named_values(varied: Variation) -> Sequence[tuple[str, str, Any]]:
    """Place, name and value of each; with a number where several have the same name."""
    shown = [_shown(value) for value in varied.values]
    times = Counter(shown)
    return [
        (varied.place, f"{word} {number}" if times[word] > 1 else word, value)
        for number, (word, value) in enumerate(zip(shown, varied.values, strict=True), 1)
    ]


def _shown(value: Any) -> str:
    """A value in a render's name: of a part of a scene its name or its type, of much the beginning."""
    if isinstance(value, dict):
        value = next((value[key] for key in ("name", "type") if isinstance(value.get(key), str)), value)
    text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
    return text if len(text) <= _MAX_SHOWN else f"{text[: _MAX_SHOWN - 1]}\u2026"


def _between(value: Any, part: float) -> Any:
    match = _FROM_TO.fullmatch(value.strip()) if isinstance(value, str) else None
    if match is None:
        return value
    start, end = float(match[1]), float(match[2])
    return start + part * (end - start)
