"""What tests of the page give to a browser: renders, files, and a script that visits the page."""

import json
import os
import secrets
import subprocess
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import httpx

ROOT = Path(__file__).parents[2]
NODE = ROOT / ".venv" / "bin" / "node"
TIMEOUT_S = 1200
"""A guard only: the visit takes two minutes where nothing else runs."""


def submit(url: str, scene: dict[str, Any], film: tuple[int, int], samples: int, group: str = "") -> str:
    """Submits a scene; gives the render's id."""
    body = {
        "request_id": secrets.token_hex(8),
        "name": scene.get("name", "scene"),
        "scene": scene,
        "width": film[0],
        "height": film[1],
        "samples": samples,
        "group": group,
    }
    response = httpx.post(f"{url}/v1/renders", json=body, timeout=300)
    assert response.status_code == 201, response.text
    return str(response.json()["id"])


def has_ended(url: str, render_id: str) -> bool:
    return str(httpx.get(f"{url}/v1/renders/{render_id}").json()["state"]) == "SUCCEEDED"


def archive_of(folder: Path, target: Path) -> Path:
    """A ZIP of a scene's folder, as people make them."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.rglob("*.json")):
            archive.write(file, f"{folder.name}/{file.relative_to(folder)}")
    return target


def visit(script: str, given: Mapping[str, Any]) -> None:
    """Runs a script of this folder in Node.js; if it fails, fails with its output."""
    result = subprocess.run(
        [NODE, ROOT / "tests/web" / script],
        env=os.environ | {"NOCTURNE_E2E": json.dumps(given)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert result.returncode == 0, result.stdout
