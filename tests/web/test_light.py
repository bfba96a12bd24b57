"""The page for those who plan a room's light, in Debian's Chromium, against the real service."""

import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from nocturne_client.cli.app import app
from nocturne_client.client import Client
from typer.testing import CliRunner

from tests.accuracy.test_daylight_coefficients import room
from tests.system.up import Up
from tests.system.waiting import wait_for
from tests.weather import epw
from tests.web.visit import ROOT, visit

pytestmark = pytest.mark.system


@pytest.fixture
def up(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Up]:
    with Up(tmp_path_factory.mktemp("up"), 1, 2) as service:
        yield service


def _year(url: str, folder: Path) -> list[str]:
    """Renders of a small room's coefficients."""
    document = room(0.5, [])
    grid = {"corner": [0, 0.8, 4], "right": [4, 0, 0], "up": [0, 0, -4], "columns": 6, "rows": 4}
    document["sensor"] = {"type": "meters", "instruments": [{"name": "plane", "grid": grid}]}
    (folder / "room.json").write_text(json.dumps(document))
    (folder / "year.epw").write_text(epw())
    few = ["--set", "sensor.daylight.patches=145", "--set", "sensor.daylight.sun_patches=145"]
    asked = ["submit", str(folder / "room.json"), "--annual", str(folder / "year.epw"), "--samples", "512"]
    result = CliRunner().invoke(app, [*asked, *few, "--url", url], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout.split("\n")[1:4]


def test_the_page_for_those_who_plan_light(up: Up, tmp_path: Path) -> None:
    office = tmp_path / "office"
    shutil.copytree(ROOT / "examples" / "office", office)
    with Client(up.url) as client:
        in_room = client.submit(office / "scene.json", 8, 8, 256).id
        renders = [*_year(up.url, tmp_path), in_room]
        wait_for(lambda: all(client.get(each).has_ended for each in renders), "the renders to end", 300)
    given = {
        "url": up.url,
        "year": renders[0],
        "room": in_room,
        "screenshots": os.environ.get("NOCTURNE_SCREENSHOTS", ""),
    }
    visit("light.e2e.mjs", given)
