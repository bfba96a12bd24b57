"""Usage by owner, and its cost."""

import asyncio
from pathlib import Path

import httpx
import pytest
from nocturne_api.service import Settings
from nocturne_client.cli.app import app
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.usage import UsageOfOwners
from typer.testing import CliRunner

from tests.services.endpoints import rest_client, started
from tests.services.webhook_receiver import make_render


def used(folder: DataFolder, render_id: str, owner: str, hours: float, state: str = "SUCCEEDED") -> None:
    make_render(folder, render_id, owner)
    folder.database.execute(
        "UPDATE render SET cpu_seconds = ?, state = ? WHERE id = ?", (3600.0 * hours, state, render_id)
    )


async def test_owners_have_shares_hours_and_costs(tmp_path: Path) -> None:
    folder = DataFolder(tmp_path / "data")
    settings = Settings(
        data=folder.root, web=folder.root, port=0, grpc_port=0, core_hour_price=0.04, currency="CHF"
    )
    async with started(settings) as service, rest_client(service) as rest:
        assert (await rest.get("/v1/usage")).json()["owners"] == []
        folder.tokens.create("ann", ["submit"], 300)
        used(folder, "r-1", "ann", 10.0)
        used(folder, "r-2", "ann", 5.0, "RUNNING")
        used(folder, "r-3", "bob", 25.0, "PAUSED")
        folder.database.execute("INSERT INTO coordinator VALUES (1, 2e9)")
        for tile, render in enumerate(("r-2", "r-2", "r-2", "r-3")):
            folder.database.execute("INSERT INTO at_work VALUES (1, ?, ?, 'w', 0)", (render, tile))
        usage = (await rest.get("/v1/usage")).json()
        assert (usage["core_hour_price"], usage["currency"]) == (0.04, "CHF")
        bob, ann = usage["owners"]
        assert (ann["owner"], ann["renders"], ann["open_renders"], ann["weight"]) == ("ann", 2, 1, 300)
        assert (ann["share"], ann["cpu_seconds"], ann["cost"]) == (0.75, 54000.0, pytest.approx(0.6))
        assert (bob["share"], bob["weight"], bob["cost"]) == (0.25, 100, pytest.approx(1.0))
        # Usage stays after the render is deleted.
        folder.database.execute("DELETE FROM render WHERE id = 'r-1'")
        _, ann = (await rest.get("/v1/usage")).json()["owners"]
        assert (ann["renders"], ann["open_renders"], ann["cpu_seconds"]) == (2, 1, 54000.0)
        await shown(f"http://127.0.0.1:{service.port}")
    folder.close()


async def shown(url: str) -> None:
    """By the command line."""

    def run(*words: str) -> str:
        return CliRunner().invoke(app, [*words, "--url", url]).output

    table = await asyncio.to_thread(run, "usage")
    assert "ann" in table
    assert "0.60 CHF" in table
    assert "5 core hours, 0.20 CHF" in await asyncio.to_thread(run, "get", "r-2")


async def test_an_owner_sees_its_own_usage_only(rest: httpx.AsyncClient, folder: DataFolder) -> None:
    used(folder, "r-1", "ann", 1.0)
    used(folder, "r-2", "bob", 1.0)
    own, _ = UsageOfOwners(folder.database).read("ann")
    assert [each.owner for each in own] == ["ann"]
    everybody = (await rest.get("/v1/usage")).json()
    assert len(everybody["owners"]) == 2
    assert everybody["core_hour_price"] == 0.0
