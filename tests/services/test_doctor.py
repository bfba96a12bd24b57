"""`nocturne doctor --url`: a service as its users find it."""

import asyncio
import json

from nocturne_api.service import Service
from nocturne_client.cli.app import app
from typer.testing import CliRunner


async def test_doctor_looks_at_a_service(service: Service) -> None:
    url = f"http://127.0.0.1:{service.port}"
    result = await asyncio.to_thread(CliRunner().invoke, app, ["doctor", "--url", url, "--json"])
    found = {each["name"]: each for each in json.loads(result.stdout)}
    assert found[f"service at {url}"]["ok"]
    assert found["may submit"]["ok"]
    assert found["clocks"]["ok"]
    assert not found["workers"]["ok"]
    assert result.exit_code == 1


async def test_doctor_tells_of_a_service_that_is_not_there() -> None:
    result = await asyncio.to_thread(
        CliRunner().invoke, app, ["doctor", "--url", "http://127.0.0.1:9", "--json"]
    )
    assert result.exit_code == 1
    assert [each["ok"] for each in json.loads(result.stdout)] == [False]
