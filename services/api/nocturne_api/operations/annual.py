"""A year of daylight of renders of its coefficients."""

import base64
import json
from collections import OrderedDict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from nocturne_coordinator.store.rows import RenderRow
from nocturne_scene.errors import InputError, NotFound

from nocturne_api.children.pools import year_in_child
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.models.renders import Render
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders

_KEPT = 16
"""Years that are not made again when they are asked for again."""
_PARTS = ("sky", "sun_reflected", "sun_straight")
_STATES = ("open", "closed")


@dataclass(frozen=True, slots=True)
class YearQuestion:
    """How a year is counted."""

    lux: float = 300.0
    """That is enough."""
    hours: tuple[float, float] = (8.0, 18.0)
    """Of the day, from and to."""
    eyes: tuple[str, ...] = ()
    """Instruments at eyes, which are no points of the room."""
    ground: float = 0.2
    """Reflectance of the ground beyond the scene."""


class Annual:
    """Years of the renders of one data folder."""

    def __init__(self, access: FolderAccess, renders: Renders, compile_limits: CompileLimits) -> None:
        self._access = access
        self._renders = renders
        self._compile_limits = compile_limits
        self._kept: OrderedDict[Any, str] = OrderedDict()

    async def year(self, render_id: str, asked: YearQuestion) -> str:
        """The year as JSON, of the group that a render of coefficients is in.

        Raises NotFound, also where the group lacks one of the renders or one lacks samples; InputError for
        renders of something else; Overloaded.
        """
        _check(asked)
        render = await self._renders.get(render_id)
        members = [(row, json.loads(scene)) for row, scene in await self._members(render)]
        own = next(scene for row, scene in members if row.id == render.id)
        year = _year_of(own)
        if year is None:
            raise InputError.at("$", "is no render of daylight coefficients")
        found = _parts(members, year)
        key = (asked, *((row.id, row.sequence) for row in found.values()))
        if (kept := self._kept.get(key)) is not None:
            self._kept.move_to_end(key)
            return kept
        job = {
            "scene": own,
            "renders": [
                states for seen in (False, True) if (states := await self._states(found, melanopic=seen))
            ],
            "folder": str(self._access.folder.root),
            "lux": asked.lux,
            "hours": asked.hours,
            "eyes": asked.eyes,
            "ground": asked.ground,
        }
        made = await year_in_child(job, self._access.folder.blobs, self._compile_limits)
        self._kept[key] = made
        if len(self._kept) > _KEPT:
            self._kept.popitem(last=False)
        return made

    async def _members(self, render: Render) -> list[tuple[RenderRow, str]]:
        """Of the render's group, newest first, with their documents; without a group, itself."""
        folder, owner = self._access.folder, render.owner

        def read() -> list[tuple[RenderRow, str]]:
            rows = [folder.renders.get(render.id)]
            if render.group:
                rows, _ = folder.renders.page(200, "", owner, render.group)
            return [(row, folder.renders.scene_document(row.id)) for row in rows]

        return await self._access.in_database(read)

    async def _states(
        self, found: Mapping[tuple[str, str, bool], RenderRow], *, melanopic: bool
    ) -> list[dict[str, Any]]:
        """Renders of the open and of the closed room, by what they are of."""
        states = []
        for blinds in _STATES:
            of_state = {
                part: await self._told(found[blinds, part, melanopic])
                for part in _PARTS
                if (blinds, part, melanopic) in found
            }
            if of_state:
                states.append(of_state)
        return states

    async def _told(self, row: RenderRow) -> dict[str, str]:
        schedule = await self._access.in_database(self._access.folder.renders.schedule, row.id)
        return {"id": row.id, "schedule": base64.b64encode(schedule.SerializeToString()).decode()}


def _check(asked: YearQuestion) -> None:
    first, last = asked.hours
    if not 0 <= first < last <= 24:
        raise InputError.at("hours", "expected two hours of a day, such as 8 and 18")
    if not 0.001 <= asked.lux <= 1e6:
        raise InputError.at("lux", "expected 0.001 to 1000000 lx")
    if not 0 <= asked.ground <= 1:
        raise InputError.at("ground", "expected 0 to 1")


def _year_of(scene: Mapping[str, Any]) -> dict[str, Any] | None:
    sensor = scene.get("sensor", {})
    daylight = sensor.get("daylight") if sensor.get("type") == "meters" else None
    return daylight if isinstance(daylight, dict) else None


def _parts(
    members: list[tuple[RenderRow, dict[str, Any]]], year: Mapping[str, Any]
) -> dict[tuple[str, str, bool], RenderRow]:
    """Of each state of the blinds, part of the light and response, the newest render. Raises NotFound."""
    found: dict[tuple[str, str, bool], RenderRow] = {}
    for row, scene in members:
        other = _year_of(scene)
        if other is not None and _same(other) == _same(year):
            blinds, melanopic = other.get("blinds", "open"), bool(other.get("melanopic", False))
            found.setdefault((blinds, other["of"], melanopic), row)
    for part in _missing(found):
        raise NotFound(f"a year takes a render of {part}, too, in the same group and of the same weather")
    return found


def _missing(found: Mapping[tuple[str, str, bool], RenderRow]) -> Iterator[str]:
    wanted = {(blinds, melanopic) for blinds, _, melanopic in found} | {("open", False)}
    for blinds, melanopic in sorted(wanted):
        for part in _PARTS:
            if (blinds, part, melanopic) not in found:
                seen = ' and "melanopic": true' if melanopic else ""
                yield f'"of": "{part}"{seen} with {blinds} blinds'


def _same(year: Mapping[str, Any]) -> dict[str, Any]:
    """What all renders of a year have in common."""
    return {key: value for key, value in year.items() if key not in ("of", "blinds", "melanopic")}
