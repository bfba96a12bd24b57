"""The last lines of `make demo` are plain, and match the image."""

import importlib.util
import sys
from pathlib import Path
from typing import Any

from tests.deploy.test_scripts import DEPLOY

IMAGE = Path("/somewhere/cornell.exr")
URL = "http://127.0.0.1:7070"


def _report(url: str = URL, **progress: Any) -> str:
    spec = importlib.util.spec_from_file_location("demo_report", DEPLOY / "demo_report.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["demo_report"] = module
    spec.loader.exec_module(module)
    known = {"relative_error": 0.1226, "mean": 17329.4, "mean_error": 12.2, "doubt": "", "cpu_seconds": 20.0}
    render = {"id": "r-1", "width": 512, "height": 512, "samples": 64, "unit": "cd/m2", "progress": known}
    known |= progress
    return str(module.report(render, IMAGE, url))


def test_it_says_what_is_where_and_what_the_error_means() -> None:
    said = _report()
    for part in (
        "512 x 512 pixels with 64 samples",
        "/somewhere/cornell.png",
        "/somewhere/cornell.exr",
        f"{URL}/#/renders/r-1",
        "about 12 %",
        "17329 +- 24 cd/m2",
        ".venv/bin/nocturne extend r-1 --samples 1024",
        "make stop",
    ):
        assert part in said, part
    assert "NOCTURNE_URL" not in said
    assert "may be too small" not in said
    assert max(map(len, said.splitlines())) < 120


def test_a_doubt_is_told_and_so_is_another_port() -> None:
    said = _report("http://127.0.0.1:8080", doubt="Few bright samples carry the light.")
    assert "may be too small:\nFew bright samples carry the light." in said
    assert "  NOCTURNE_URL=http://127.0.0.1:8080 .venv/bin/nocturne extend" in said
    assert "not known yet" in _report(relative_error=0.0)
