"""A polarised render through the service has the bits of a local one: signed sums go through partials,
audits, merging and images."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.cli.app import app
from nocturne_client.contract import Outline, Region
from nocturne_client.local.measuring import measure_file
from nocturne_client.local.render import LocalRender, render_scene
from typer.testing import CliRunner

from tests.system.images import Image, differing_values
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for

pytestmark = pytest.mark.system

# Two tiles that are cut, of several ranges each.
_WIDTH, _HEIGHT, _SAMPLES = 40, 16, 64

_SCENE: dict[str, Any] = {
    "nocturne": 1,
    "sensor": {
        "type": "pinhole",
        "position": [0, -3, 1],
        "look_at": [0, 0, 0.3],
        "up": [0, 0, 1],
        "vertical_field_of_view_degrees": 40,
        "stokes": True,
        "bands": {"first": 400, "last": 700, "width": 150},
    },
    "media": {"air": {"scattering": 0.2, "phase": {"type": "rayleigh"}}},
    "unbounded_media": ["air"],
    "surfaces": [
        {
            "shape": {"type": "quad", "corner": [-2, -2, 0], "edge_u": [4, 0, 0], "edge_v": [0, 4, 0]},
            "kernel": {"type": "conductor", "index": {"n": 0.9, "k": 3.2}, "roughness": 0.4},
        },
        {
            "shape": {"type": "quad", "corner": [-1, 1, 0], "edge_u": [0, 0, 1.5], "edge_v": [2, 0, 0]},
            "kernel": {"type": "lambertian", "reflectance": 0.0},
            "luminaire": {"radiance": 2.0, "two_sided": True},
        },
    ],
}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceProcesses]:
    running = ServiceProcesses(
        tmp_path_factory.mktemp("polarised"), "--audit-share", "1", "--audit-share-new", "1"
    )
    running.start()
    running.have_workers(2)
    yield running
    running.close()


def test_the_service_renders_what_a_local_render_does(service: ServiceProcesses, tmp_path: Path) -> None:
    scene, local = tmp_path / "scene.json", tmp_path / "local.exr"
    scene.write_text(json.dumps(_SCENE))
    render_scene(LocalRender(scene, [local], _WIDTH, _HEIGHT, _SAMPLES, 1))
    service.wait_for_workers()
    asked = service.client.submit(scene, _WIDTH, _HEIGHT, _SAMPLES)
    wait_for(lambda: service.client.get(asked.id).has_ended, "the render to end")
    render = service.client.get(asked.id)
    assert (render.state, render.reason) == ("SUCCEEDED", "")
    # Every range was traced by both workers, who agree.
    assert render.progress.audited > 0
    assert render.progress.refused == 0
    assert len(service.contributors(asked.id)) == 2
    found = service.client.download(asked.id, "exr", tmp_path / "service.exr")
    here, there = Image.read(local), Image.read(found)
    assert {"S1.Y", "S2.X", "S3.475,000000nm", "S1.625,000000nm"} <= here.further.keys()
    assert differing_values(here, there) == {}
    # Light is polarised with both signs; no test of zeros.
    for name in ("S1.Y", "S2.Y", "S3.Y"):
        assert here.further[name].min() < 0.0 < here.further[name].max()
    assert np.all(np.abs(here.further["S1.Y"]) <= here.y * (1 + 1e-5))
    compared = CliRunner().invoke(app, ["compare", str(found), str(local), "--json"])
    assert compared.exit_code == 0, compared.output
    told = json.loads(compared.output)
    assert "S1.Y" in told["channels"]
    assert np.nanmax(np.abs(told["mean_z"])) == 0.0
    one, other = told["linear_polarisation"]
    assert one == other
    low, high = one["degree_interval"]
    mean = {name: float(here.further[name].mean()) for name in ("S1.Y", "S2.Y")}
    assert low <= np.hypot(mean["S1.Y"], mean["S2.Y"]) / here.y.mean() <= high
    assert low < one["degree"] < high
    _check_told(service, asked.id, found, one)


def _check_told(service: ServiceProcesses, render: str, image: Path, whole: dict[str, Any]) -> None:
    """The service says of its render what the command line says of its file, also of a pixel."""
    reading = service.client.read_region(render, Region(0, 0, _WIDTH, _HEIGHT)).linear_polarisation
    assert reading is not None
    assert reading.degree == pytest.approx(whole["degree"], rel=1e-3)
    pixel = [Outline("", "rectangle", [[20.0, 8.0], [21.0, 9.0]])]
    (there,) = service.client.measure(render, pixel, "Y", 0).measurements
    (here,) = measure_file(image, pixel, "Y", 0).measurements
    assert there.linear_polarisation is not None
    assert here.linear_polarisation is not None
    low, high = there.linear_polarisation.degree_interval
    assert 0.0 <= low < high < 0.5
    assert here.linear_polarisation.degree == pytest.approx(there.linear_polarisation.degree, rel=1e-2)
    assert here.linear_polarisation.degree_interval == pytest.approx([low, high], rel=0.05, abs=1e-3)
