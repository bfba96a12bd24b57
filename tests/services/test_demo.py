"""The last lines of `nocturne demo` are plain, and match the image."""

import sys
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import pytest
from nocturne_client.cli.demo_command import DemoPlaces, report
from nocturne_client.contract import Progress
from nocturne_client.models import Render

IMAGE = Path("/somewhere/cornell.exr")


@pytest.fixture(autouse=True)
def _called(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", [".venv/bin/nocturne"])


_Model = TypeVar("_Model")


def _some(model: type[_Model], **known: Any) -> _Model:
    return model(**{each.name: known.get(each.name, 0) for each in fields(model)})  # type: ignore[arg-type]


def _report(port: int = 7070, **progress: Any) -> str:
    known = {
        "relative_error": 0.1226,
        "mean": 17329.4,
        "mean_error": 12.2,
        "error_warning": "",
        "cpu_seconds": 20.0,
    }
    so_far = _some(Progress, **known | progress)
    film = {"width": 512, "height": 512, "samples": 64, "unit": "cd/m2"}
    return report(
        _some(Render, id="r-1", progress=so_far, **film), IMAGE, DemoPlaces(Path("/data"), port, IMAGE.parent)
    )


def test_it_says_what_is_where_and_what_the_error_means() -> None:
    said = _report()
    for part in (
        "512 x 512 pixels with 64 samples",
        "/somewhere/cornell.png",
        "/somewhere/cornell.exr",
        "http://127.0.0.1:7070/#/renders/r-1",
        "about 12 %",
        "17329 +- 24 cd/m2",
        "  .venv/bin/nocturne extend r-1 --samples 1024",
        ".venv/bin/nocturne down --data /data",
    ):
        assert part in said, part
    assert "NOCTURNE_URL" not in said
    assert "may be too small" not in said
    assert max(map(len, said.splitlines())) < 120


def test_a_doubt_is_told_and_so_is_another_port() -> None:
    said = _report(8080, error_warning="Few bright samples carry the light.")
    assert "may be too small:\nFew bright samples carry the light." in said
    assert "  NOCTURNE_URL=http://127.0.0.1:8080 .venv/bin/nocturne extend" in said
    assert "not known yet" in _report(relative_error=0.0)
