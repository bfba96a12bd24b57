"""The page in Debian's Chromium, against the real service with real workers."""

import json
import os
import subprocess
import uuid
from pathlib import Path
from typing import Protocol

import httpx
import pytest

ROOT = Path(__file__).parents[2]
NODE = ROOT / ".venv" / "bin" / "node"
TIMEOUT_S = 180


class Service(Protocol):
    """What the fixture `running_service` yields."""

    url: str
    data: Path


def submit_cornell(url: str, samples: int) -> str:
    """Submits the Cornell box, 128 x 128, and returns the render's id."""
    scene = json.loads((ROOT / "scenes" / "cornell" / "scene.json").read_text())
    body = {
        "request_id": str(uuid.uuid4()),
        "name": "cornell",
        "scene": scene,
        "width": 128,
        "height": 128,
        "samples": samples,
    }
    response = httpx.post(f"{url}/v1/renders", json=body, timeout=30)
    assert response.status_code == 201, response.text
    return str(response.json()["id"])


@pytest.mark.system
def test_page_shows_a_render_live(running_service: Service, tmp_path: Path) -> None:
    assert (ROOT / "services/web/dist/index.html").is_file(), "run npm run build in services/web"
    screenshots = Path(os.environ.get("NOCTURNE_SCREENSHOTS", tmp_path / "screenshots"))
    environment = os.environ | {
        "NOCTURNE_URL": running_service.url,
        "NOCTURNE_RENDER": submit_cornell(running_service.url, samples=64),
        "NOCTURNE_LONG_RENDER": submit_cornell(running_service.url, samples=1 << 20),
        "NOCTURNE_SCREENSHOTS": str(screenshots),
    }
    result = subprocess.run(
        [NODE, ROOT / "tests/web/page.e2e.mjs"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert result.returncode == 0, result.stdout
