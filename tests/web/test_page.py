"""The page in Debian's Chromium, against the real service with real workers."""

import gzip
import io
import json
import os
import re
import sqlite3
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import OpenEXR
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_coordinator.store.data_folder import DataFolder

from tests.pool import FILM, SAMPLES, pool
from tests.system.free_ports import free_port_pair
from tests.system.program import Program
from tests.system.up import Up
from tests.system.waiting import wait_for
from tests.web.visit import ROOT, archive_of, has_ended, submit, visit

DIST = ROOT / "services/web/dist"
PIXEL = (70, 90)

PANORAMA: dict[str, Any] = {
    "nocturne": 1,
    "name": "lamp in the sky",
    "sensor": {"type": "panorama", "position": [0, 0, 0], "look_at": [0, 0, -1], "up": [0, 1, 0]},
    "environment": {"radiance": 1},
    "surfaces": [
        {
            "shape": {"type": "sphere", "centre": [0, 1, -4], "radius": 0.3},
            "kernel": {"type": "lambertian", "reflectance": 0.0},
            "luminaire": {"radiance": 100},
        }
    ],
}
"""Glare has something to find."""

DOUBTFUL: dict[str, Any] = {
    "kind": "missing_in_parts",
    "sentence": "reflections, refractions or caustics of small bright light sources may be missing",
    "parts": [{"x": 0, "y": 0, "width": 32, "height": 32, "part": 0.3}],
}
"""What a pilot says of the left upper quarter of 64 x 64 pixels; put into the data folder, as for a test of a
page it does not matter whether it is right."""

QUARANTINE = """
import sqlite3, sys, time
with sqlite3.connect(sys.argv[1], timeout=20) as database:
    database.execute("INSERT INTO quarantine VALUES (?, 'for a test', ?)", (sys.argv[2], time.time()))
"""
"""Puts a worker in quarantine, as a coordinator does whose audits it failed."""


@pytest.fixture
def page_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Up]:
    """A worker of one thread: renders that are looked at until they are cancelled cost half as much."""
    with Up(tmp_path_factory.mktemp("up"), 1, 1) as service:
        yield service


@pytest.fixture
def guarded_url(page_service: Up, tmp_path: Path) -> Iterator[str]:
    """Another API on the same data folder, which asks for tokens."""
    port = free_port_pair()
    ports = ["--port", str(port), "--grpc-port", str(port + 1)]
    command = [sys.executable, "-m", "nocturne_api.main", "--data", str(page_service.data), *ports]
    api = Program([*command, "--web", str(DIST), "--auth"], tmp_path / "api.log")
    api.start()
    try:
        url = f"http://127.0.0.1:{port}"
        wait_for(lambda: _answers(url), "the API with tokens")
        yield url
    finally:
        api.end()


def _answers(url: str) -> bool:
    try:
        return httpx.get(f"{url}/readyz?exclude=merging").status_code == 200
    except httpx.TransportError:
        return False


def token(data: Path) -> str:
    """One that may read."""
    folder = DataFolder(data)
    try:
        return folder.tokens.create("visitor", ["read"])
    finally:
        folder.close()


def pixel_of(exr: Path) -> dict[str, Any]:
    """One pixel's X, Y, Z and standard error, as another reader finds them."""
    image = oiio.ImageBuf(str(exr))
    channels = [image.spec().channelnames.index(name) for name in ("X", "Y", "Z", "Y.stderr")]
    x, y = PIXEL
    values = np.asarray(image.get_pixels(oiio.FLOAT))[y, x, channels]
    return {"x": x, "y": y, "values": [float(value) for value in values]}


def as_mitsuba_writes_it(exr: Path, copy: Path) -> Path:
    """The same image with the compression that Mitsuba and OpenEXR take by themselves."""
    with OpenEXR.File(str(exr), separate_channels=True) as image:
        header = {**image.header(), "compression": OpenEXR.PIZ_COMPRESSION}
        channels = {name: channel.pixels for name, channel in image.channels().items()}
    with OpenEXR.File({key: header[key] for key in ("compression", "type")}, channels) as other:
        other.write(str(copy))
    return copy


@pytest.mark.system
@pytest.mark.parametrize("brief", [True, pytest.param(False, marks=pytest.mark.soak)], ids=["brief", "whole"])
def test_the_page(brief: bool, page_service: Up, guarded_url: str, tmp_path: Path) -> None:
    assert (DIST / "index.html").is_file(), "run npm run build in services/web"
    url = page_service.url
    cornell = json.loads((ROOT / "examples" / "cornell" / "scene.json").read_text())
    guided = submit(url, pool(), FILM, SAMPLES)
    # The smaller one has no pilot, so that its pixels are alone and its noise is another.
    small, other = (submit(url, cornell, (128, 128), samples, "boxes") for samples in (64, 8))
    around = submit(url, PANORAMA, (64, 32), 4)
    unmet = submit(url, cornell, (64, 64), 4)
    wait_for(
        lambda: all(has_ended(url, each) for each in (small, other, around, unmet, guided)),
        "renders to end",
        400,
    )
    with sqlite3.connect(page_service.data / "nocturne.db", timeout=20) as database:
        database.execute("UPDATE render SET engine = engine - 1 WHERE id = ?", (other,))
        database.execute("UPDATE render SET warnings = ? WHERE id = ?", (json.dumps([DOUBTFUL]), unmet))
    exr = tmp_path / "small.exr"
    exr.write_bytes(httpx.get(f"{url}/v1/renders/{small}/image.exr").content)
    given = {
        "url": url,
        "api_pid": page_service.children()["api"],
        "auth_url": guarded_url,
        "token": token(page_service.data),
        "small": small,
        "other": other,
        "panorama": around,
        "guided": guided,
        "unmet": unmet,
        "quarantine": [sys.executable, "-c", QUARANTINE, str(page_service.data / "nocturne.db")],
        "exr": str(as_mitsuba_writes_it(exr, tmp_path / "piz.exr")),
        "pixel": pixel_of(exr),
        "archive": str(archive_of(ROOT / "examples" / "cornell", tmp_path / "cornell.zip")),
        "scene_folder": str(ROOT / "examples" / "cornell"),
        "brief": brief,
        "screenshots": os.environ.get("NOCTURNE_SCREENSHOTS", ""),
    }
    visit("page.e2e.mjs", given)


def test_the_script_is_small() -> None:
    """What a first visit fetches, as a proxy would compress it; the API's reference is another page."""
    total = 0
    for name in re.findall(r"/assets/[\w.-]+\.js", (DIST / "index.html").read_text()):
        script = DIST / name.removeprefix("/")
        packed = io.BytesIO()
        with gzip.GzipFile(fileobj=packed, mode="wb", mtime=0) as file:
            file.write(script.read_bytes())
        total += len(packed.getvalue())
    assert 10_000 < total < 80_000
