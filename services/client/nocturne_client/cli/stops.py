"""Stop conditions as people type them: 2 %, 90 min, until 07:00."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Annotated, Any

import typer

_DURATION = re.compile(r"(\d+(?:\.\d+)?)\s*(s|m|min|h|d)")
_SECONDS = {"s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
_SHARE = re.compile(r"(\d+(?:\.\d+)?)\s*(%)?")
_CLOCK = re.compile(r"(\d{1,2}):(\d{2})")

Error = Annotated[
    str, typer.Option("--error", help='Stop at this relative error of the image: "1%" or 0.01.')
]
TileError = Annotated[
    str,
    typer.Option(
        "--tile-error", help="Each tile stops when its own relative error is this small: noisy ones go on."
    ),
]
For = Annotated[str, typer.Option("--for", help='Stop after running so long: "90 min", "8h".')]
Cpu = Annotated[str, typer.Option("--cpu", help='Stop after so much processor time: "40h".')]
Until = Annotated[
    str,
    typer.Option(
        "--until", help='Stop at this time: "07:00" here, "07:00 Europe/Berlin", "2026-11-22T07:00:00Z".'
    ),
]


Drop = Annotated[
    list[str] | None,
    typer.Option(
        "--drop", metavar="CONDITION", help="Drop this condition: error, tile-error, for, cpu or until."
    ),
]
_NAMES = {
    "error": "relative_error",
    "tile-error": "tile_relative_error",
    "for": "wall_seconds",
    "cpu": "cpu_seconds",
    "until": "until",
}


@dataclass(frozen=True)
class Stops:
    """The typed texts; empty: not asked for."""

    error: str = ""
    tile_error: str = ""
    duration: str = ""
    cpu: str = ""
    until: str = ""

    def asked(self) -> dict[str, Any]:
        """The conditions as the service takes them; typer.BadParameter for other texts."""
        values: dict[str, Any] = {
            "relative_error": share(self.error, "--error"),
            "tile_relative_error": share(self.tile_error, "--tile-error"),
            "wall_seconds": _seconds(self.duration, "--for"),
            "cpu_seconds": _seconds(self.cpu, "--cpu"),
            "until": with_zone(self.until, datetime.now()),  # noqa: DTZ005 - the clock on this wall
        }
        return {name: value for name, value in values.items() if value}


def with_zone(text: str, now: datetime) -> str:
    """A clock time without a zone is the next on this machine's clock; all else stays as it is.

    `now`: local time, without a zone.
    """
    clock = _CLOCK.fullmatch(text.strip())
    if clock is None:
        return text
    try:
        moment = now.replace(hour=int(clock[1]), minute=int(clock[2]), second=0, microsecond=0)
    except ValueError:
        return text
    if moment <= now:
        moment += timedelta(days=1)
    # Only now the zone: tomorrow's may be another, with or without summer time.
    return moment.astimezone().isoformat()


def dropped(options: Sequence[str]) -> dict[str, str]:
    """The service's names of conditions, by those of the options; typer.BadParameter for others."""
    wrong = next((each for each in options if each.removeprefix("--") not in _NAMES), None)
    if wrong is not None:
        raise typer.BadParameter(f"{wrong!r}: expected {', '.join(_NAMES)}", param_hint="--drop")
    return {each.removeprefix("--"): _NAMES[each.removeprefix("--")] for each in options}


def share(text: str, option: str) -> float:
    """A part of one, such as 1 % or 0.01; 0 where nothing was typed. Raises typer.BadParameter."""
    if not text:
        return 0.0
    match = _SHARE.fullmatch(text.strip())
    if match is None:
        raise typer.BadParameter(f'{text!r}: expected "1%" or 0.01', param_hint=option)
    if not float(match[1]):
        raise typer.BadParameter(_nothing(text), param_hint=option)
    part = float(match[1]) / (100.0 if match[2] else 1.0)
    if part >= 1.0:
        raise typer.BadParameter(
            f'{text!r}: expected less than 100 %, such as "1%" or 0.01', param_hint=option
        )
    return part


def _seconds(text: str, option: str) -> float:
    if not text:
        return 0.0
    match = _DURATION.fullmatch(text.strip())
    if match is None:
        raise typer.BadParameter(
            f'{text!r}: expected a number with its unit, "90 s", "15 min", "8h" or "2 d"', param_hint=option
        )
    if not float(match[1]):
        raise typer.BadParameter(_nothing(text), param_hint=option)
    return float(match[1]) * _SECONDS[match[2]]


def _nothing(text: str) -> str:
    return f"{text!r} is never met or met at once; leave the option out to go on without it"
