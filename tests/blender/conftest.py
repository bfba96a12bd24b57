"""Tests with Blender's own Python module are skipped where it is not installed."""

import pytest

from tests.blender.blender import PYTHON


@pytest.fixture(autouse=True, scope="session")
def _installed() -> None:
    if not PYTHON.exists():
        pytest.skip("Blender's Python module is not installed; `make blender` installs it into build/blender")
