"""What the page promises about time, where nothing else runs: `make page-times`."""

from pathlib import Path
from typing import Any

import pytest

from tests.system.up import Up
from tests.system.waiting import wait_for
from tests.web.visit import ROOT, archive_of, has_ended, submit, visit

ONE_LAMP: dict[str, Any] = {
    "nocturne": 1,
    "name": "4K",
    "sensor": {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "up": [0, 1, 0],
        "vertical_field_of_view_degrees": 40,
    },
    "surfaces": [
        {
            "shape": {"type": "quad", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]},
            "kernel": {"type": "lambertian", "reflectance": 0.0},
            "luminaire": {"radiance": {"blackbody": 3000}},
        }
    ],
}
"""A photon of it ends at its first hit: a large film is there soon."""


@pytest.mark.times
def test_what_the_page_promises_about_time(running_service: Up, tmp_path: Path) -> None:
    url = running_service.url
    large = submit(url, ONE_LAMP, (3840, 2160), 1)
    wait_for(lambda: has_ended(url, large), "the large render to end", 400)
    archive = archive_of(ROOT / "examples" / "cornell", tmp_path / "cornell.zip")
    visit("times.e2e.mjs", {"url": url, "large": large, "archive": str(archive)})
