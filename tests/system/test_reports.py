"""Reports that a service makes of its renders, by the program `nocturne report`."""

import json
import shutil
from collections.abc import Iterator

import httpx
import pytest
from nocturne_client.local.programs import CHECKOUT
from nocturne_client.models import Render

from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for

pytestmark = pytest.mark.system

OFFICE = CHECKOUT / "examples" / "office"


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceProcesses]:
    running = ServiceProcesses(tmp_path_factory.mktemp("reports"))
    running.start()
    running.have_workers(2)
    yield running
    running.close()


@pytest.fixture(scope="module")
def office(service: ServiceProcesses, tmp_path_factory: pytest.TempPathFactory) -> list[Render]:
    """The office's meters, and an eye in it, in one group. The scene has a photometric file."""
    folder = tmp_path_factory.mktemp("office")
    shutil.copytree(OFFICE, folder, dirs_exist_ok=True)
    service.wait_for_workers()
    asked = [
        service.client.submit(folder / name, *film, samples, group="office")
        for name, film, samples in (("scene.json", (8, 8), 64), ("eye.json", (64, 32), 16))
    ]
    for each in asked:
        wait_for(lambda each=each: service.client.get(each.id).has_ended, "the renders to end", 120)  # type: ignore[misc]
    return asked


def _get(service: ServiceProcesses, render: Render, rest: str, **params: str) -> httpx.Response:
    url = f"{service.client.url}/v1/renders/{render.id}/{rest}"
    return httpx.get(url, params=params, timeout=120)


def test_a_report_has_what_the_group_knows(service: ServiceProcesses, office: list[Render]) -> None:
    meters, eye = office
    asked = {"require": "EN 12464-1:34.2", "title": "Room 7 <b>"}
    answer = _get(service, meters, "report.html", **asked)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    # Nothing of it runs.
    assert answer.headers["content-security-policy"].startswith("default-src 'none'")
    page = answer.text
    assert "Room 7 &lt;b&gt;" in page
    for told in ("Em, working plane", "OFFICE-600", "maintenance factor", "UGR", meters.scene_sha256):
        assert told in page
    # The eye is the other render of the group.
    assert eye.id[:8] in page
    words = _get(service, meters, "report.json", **asked).json()
    assert [each["what"] for each in words["checks"]][:2] == ["Em, working plane", "U0, working plane"]
    assert words["verdict"] in ("holds", "fails", "open")
    assert words["sections"][0]["tables"][0]["rows"]
    pdf = _get(service, meters, "report.pdf", **asked)
    assert pdf.headers["content-type"] == "application/pdf"
    assert pdf.content.startswith(b"%PDF-1.4")


def test_a_report_that_cannot_be_made_says_why(service: ServiceProcesses, office: list[Render]) -> None:
    meters, eye = office
    wrong = _get(service, meters, "report.pdf", require="EN 12464-1:99")
    assert (wrong.status_code, wrong.json()["problems"][0]["place"]) == (422, "require")
    assert _get(service, meters, "report.pdf", task="--require").status_code == 422
    other = _get(service, eye, "report.pdf")
    assert other.status_code == 404
    assert "which measure illuminance" in json.dumps(other.json())
    nowhere = _get(service, meters, "report.pdf", task="desk")
    assert "expected one of" in json.dumps(nowhere.json())
