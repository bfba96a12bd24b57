"""The committed reference of the scene document is the one that the schema gives."""

import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs" / "reference"


@pytest.mark.parametrize(("arguments", "name"), [([], "scene.md"), (["--schema"], "scene.schema.json")])
def test_the_committed_reference_is_current(arguments: list[str], name: str) -> None:
    module = "nocturne_scene.document.reference"
    run = subprocess.run([sys.executable, "-m", module, *arguments], capture_output=True, check=True)
    assert run.stdout.decode() == (DOCS / name).read_text("utf-8"), f"make it again: python -m {module}"
