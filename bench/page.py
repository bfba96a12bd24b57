"""How soon the page shows a render's first tile in Chromium, and how smoothly it moves.

What moves is a list of 500 renders, and an image of 3840 x 2160 pixels.
"""

import json
import os
import shutil
import sqlite3
import subprocess
from pathlib import Path

from nocturne_client import Client
from nocturne_client.local.programs import CHECKOUT

from bench.report import Figures, Row, Skipped, spread, spread_text
from bench.running_service import RunningService, running_service
from bench.scenes import CORNELL
from tests.web.visit import archive_of

AIM_FIRST_MS, AIM_UPDATE_MS = 1200.0, 1000.0
"""From Render to the first tile, with a pilot and two layers; between changes of the image after that."""
AIM_MS, AIM_IMAGES = 50.0, 30.0
"""A frame that takes three of a screen's is seen; images of a pan."""
_RENDERS = 500
_LARGE = (3840, 2160)
_NODE = CHECKOUT / ".venv" / "bin" / "node"
_TIMEOUT_S = 300.0


def run(quick: bool) -> Figures:
    """The service has nothing else to do; colours are drawn by software, without a graphics card."""
    if not _NODE.exists():
        raise Skipped(f"needs Node in {_NODE}")
    renders = 60 if quick else _RENDERS
    with running_service(workers=1, threads=2) as service:
        archive = archive_of(CORNELL.parent, service.data.with_name("cornell.zip"))
        asked = {"url": service.url, "archive": str(archive), "rounds": 1 if quick else 5}
        times = _in_browser(asked)
        with Client(service.url) as client:
            small = client.submit(CORNELL, 64, 64, 16).id
            large = client.submit(CORNELL, *_LARGE, 1).id
            for each in (small, large):
                *_, _ended = client.watch(each)
        _copy(service, small, renders)
        moved = _in_browser({"url": service.url, "rounds": 0, "renders": renders, "large": large})
    return {"submitting": {name: spread(each) for name, each in times.items()}} | moved


def _in_browser(asked: Figures) -> Figures:
    result = subprocess.run(
        [_NODE, CHECKOUT / "tests" / "web" / "page.bench.mjs"],
        env=os.environ | {"NOCTURNE_BENCH": json.dumps(asked)},
        stdout=subprocess.PIPE,
        text=True,
        timeout=_TIMEOUT_S,
        check=True,
    )
    found: Figures = json.loads(result.stdout)
    return found


def rows(figures: Figures) -> list[Row]:
    """The wait for a first tile and for further ones, the longest frame of each, and the images of a pan."""
    submitting, scrolling, filtering = figures["submitting"], figures["scrolling"], figures["filtering"]
    return [
        Row(
            "Render to the first tile on the page, with two layers, ms",
            spread_text(submitting["first_ms"]),
            f"at most {AIM_FIRST_MS:g}",
        ),
        Row(
            "then between changes of the image, ms",
            spread_text(submitting["update_ms"]),
            f"at most {AIM_UPDATE_MS:g}",
        ),
        Row(
            f"list of {figures['rows']}, scrolled: longest frame, ms",
            f"{scrolling['longest_ms']:g} (95 % below {scrolling['p95_ms']:g})",
            f"at most {AIM_MS:g}",
        ),
        Row(
            "the same, filtered as one types: longest frame, ms",
            f"{filtering['longest_ms']:g} (95 % below {filtering['p95_ms']:g})",
            f"at most {AIM_MS:g}",
        ),
        Row(
            "3840 x 2160, panned: images/s",
            f"{figures['panning']['images_per_s']:g}",
            f"at least {AIM_IMAGES:g}",
        ),
    ]


def _copy(service: RunningService, render_id: str, count: int) -> None:
    """Makes so many copies of a render that has ended, each with its own picture."""
    images = service.data / "images"
    with sqlite3.connect(service.data / "nocturne.db", timeout=20) as database:
        columns = [row[1] for row in database.execute("PRAGMA table_info(render)") if row[1] != "number"]
        other = {"id": "?1", "request_id": "?1", "name": "?2"}
        chosen = ", ".join(other.get(column, column) for column in columns)
        for index in range(count):
            copy = f"r-copy{index:06d}"
            database.execute(
                f"INSERT INTO render ({', '.join(columns)}) SELECT {chosen} FROM render WHERE id = ?3",  # noqa: S608
                (copy, f"render {index}", render_id),
            )
            shutil.copytree(images / render_id, Path(images / copy))
