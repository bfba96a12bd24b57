"""A year of daylight by a service has the bits of the local command: coefficients go through partials,
audits, merging and the data folder."""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from nocturne_client.cli.app import app
from nocturne_client.contract import Region
from nocturne_client.errors import NocturneClientError
from typer.testing import CliRunner

from tests.accuracy.test_daylight_coefficients import room
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for
from tests.weather import epw

pytestmark = pytest.mark.system

_SAMPLES = 1024
_FEW = ["--patches", "145", "--sun-patches", "145", "--samples", str(_SAMPLES), "--threads", "2"]
_AS_FEW = ["--set", "sensor.daylight.patches=145", "--set", "sensor.daylight.sun_patches=145"]


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceProcesses]:
    running = ServiceProcesses(
        tmp_path_factory.mktemp("annual"), "--audit-share", "1", "--audit-share-new", "1"
    )
    running.start()
    running.have_workers(2)
    yield running
    running.close()


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four points behind a window, an eye, a meter outdoors, and a lamp, which does not count."""
    folder = tmp_path_factory.mktemp("scene")
    document = room(0.5, [])
    grid = {"corner": [0, 0.8, 4], "right": [4, 0, 0], "up": [0, 0, -4], "columns": 2, "rows": 2}
    document["sensor"] = {
        "type": "meters",
        "instruments": [
            {"name": "plane", "grid": grid},
            {"name": "eye", "points": [[2, 1.2, 2]], "normal": [0, 0, 1]},
            {"name": "roof", "points": [[2, 10, 2]], "normal": [0, 1, 0]},
        ],
        "outdoor": "roof",
    }
    document["tracing"] = {"seed": 3}
    lamp = {"type": "quad", "corner": [1, 2.9, 1], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}
    kernel = {"type": "lambertian", "reflectance": 0.5}
    radiance = {"radiance": 1.0, "lumens": 1e5}
    document["surfaces"].append({"shape": lamp, "kernel": kernel, "luminaire": radiance})
    path = folder / "room.json"
    path.write_text(json.dumps(document))
    (folder / "year.epw").write_text(epw())
    return path


def _run(*words: str | Path) -> str:
    result = CliRunner().invoke(app, [*map(str, words)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def test_a_year_by_a_service_is_that_of_the_local_command(
    service: ServiceProcesses, scene: Path, tmp_path: Path
) -> None:
    weather, local, remote = scene.with_name("year.epw"), tmp_path / "local.json", tmp_path / "remote.json"
    # Surely: to the last sample.
    _run("annual", scene, "--weather", weather, *_FEW, "--sure", "1", "--eye", "eye", "-o", local)
    service.wait_for_workers()
    url = ["--url", service.client.url]
    asked: list[str | Path] = [
        "submit",
        scene,
        "--annual",
        weather,
        "--samples",
        str(_SAMPLES),
        *_AS_FEW,
        *url,
    ]
    group, *ids = _run(*asked).splitlines()
    assert group.startswith("group ")
    assert [service.client.get(each).sensor for each in ids] == ["daylight"] * 3
    wait_for(lambda: all(service.client.get(each).has_ended for each in ids), "the renders to end", 300)
    for each in map(service.client.get, ids):
        assert (each.state, each.reason) == ("SUCCEEDED", "")
        # Every range was traced by both workers, who agree.
        assert each.progress.audited > 0
        assert each.progress.refused == 0
    said = _run("year", ids[0], "--eye", "eye", "-o", remote, *url)
    assert remote.read_bytes() == local.read_bytes()
    found: dict[str, Any] = json.loads(remote.read_text())
    assert f"sDA300,50% {found['sDA']['value']:.1%}" in said
    assert len(found["points"]) == 5
    assert 0.0 < found["means"]["DA"]["value"] < 1.0
    # Any of the three renders gives the year.
    assert service.client.annual(ids[2], eyes=["eye"]) == remote.read_text()
    # More is asked of less light: fewer hours.
    brighter = json.loads(service.client.annual(ids[1], lux=2000.0))
    assert brighter["means"]["DA"]["value"] < found["means"]["DA"]["value"]
    # The meter outdoors: an even sky of 1 cd/m2 gives pi lx to what looks up from the roof.
    sky = next(each for each in ids if service.client.get(each).name.endswith("of=sky"))
    reading = service.client.read_region(sky, Region(1, 2, 1, 1)).values[1]
    assert reading.standard_error is not None
    assert reading.mean == pytest.approx(math.pi, abs=4 * reading.standard_error + 1e-6)
    with pytest.raises(NocturneClientError, match="no instrument has the name"):
        service.client.annual(ids[0], eyes=["door"])


def test_a_year_without_all_of_its_renders_is_refused(service: ServiceProcesses, scene: Path) -> None:
    document = json.loads(scene.read_text())
    plain = service.client.submit(scene, 8, 8, 4)
    with pytest.raises(NocturneClientError, match="no render of daylight coefficients"):
        service.client.annual(plain.id)
    document["sensor"]["daylight"] = {"of": "sky", "weather": {"asset": "year.epw"}, "patches": 145}
    alone = scene.with_name("alone.json")
    alone.write_text(json.dumps(document))
    render = service.client.submit(alone, 8, 8, 4)
    with pytest.raises(NocturneClientError, match=r"a render of .*sun_reflected"):
        service.client.annual(render.id)
    document["sensor"]["daylight"]["weather"]["asset"] = "alone.json"
    alone.write_text(json.dumps(document))
    with pytest.raises(NocturneClientError) as refused:
        service.client.submit(alone, 8, 8, 4)
    assert "expected LOCATION" in str(refused.value.problems)
