"""Warnings of a render: the same data by REST, on the command line and in the log."""

import asyncio
import json
from dataclasses import asdict

import httpx
import pytest
from nocturne_client.cli.output import print_render, print_renders
from nocturne_client.console import CONSOLE
from nocturne_client.decoding import decode
from nocturne_client.models import Render
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.render_log import log_of
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.ranges import make_schedule
from nocturne_scene.render_warnings import RenderWarning, UnmetPart, WarningKind

WARNINGS = (
    RenderWarning(WarningKind.SCENE, "$.surfaces[0].shape: bounds a body, and is open"),
    RenderWarning(
        WarningKind.MISSING_IN_PARTS,
        "reflections may be missing; the errors do not show it",
        (UnmetPart(8, 0, 8, 4, 0.25), UnmetPart(0, 4, 2, 2, 30.0)),
    ),
)


@pytest.fixture
def render_id(folder: DataFolder) -> str:
    schedule = make_schedule(16, 8, 4)
    way = "photons from the sensor: no other method was found better"
    return folder.renders.create(
        NewRender("q", "", "5c" * 32, "{}", 16, 8, 4, schedule, warnings=WARNINGS, way=way)
    ).id


async def test_renders_and_lists_have_them(render_id: str, rest: httpx.AsyncClient) -> None:
    told = (await rest.get(f"/v1/renders/{render_id}")).json()["warnings"]
    assert told == json.loads(json.dumps([each.to_json() for each in WARNINGS]))
    assert (await rest.get("/v1/renders")).json()["renders"][0]["warnings"] == told


async def test_the_command_line_says_them_and_programs_get_them(
    render_id: str, rest: httpx.AsyncClient, capsys: pytest.CaptureFixture[str], folder: DataFolder
) -> None:
    render = decode(Render, (await rest.get(f"/v1/renders/{render_id}")).json())
    with CONSOLE.capture() as said:
        print_render(render, as_json=False)
    rows = " ".join(said.get().split())
    for each in WARNINGS:
        assert f"warning {each.sentence}" in rows
    # No sentence is taken apart.
    assert rows.count("warning ") == len(WARNINGS)
    assert "traced by photons from the sensor: no other method was found better" in rows
    print_renders([render], as_json=True)
    listed = json.loads(capsys.readouterr().out)
    assert listed["warnings"] == json.loads(json.dumps([asdict(each) for each in WARNINGS]))
    log = await asyncio.to_thread(log_of, folder, render_id)
    assert f"note: {WARNINGS[1].sentence}" in log


async def test_the_data_folder_keeps_them(render_id: str, folder: DataFolder) -> None:
    assert folder.renders.get(render_id).warnings == WARNINGS
