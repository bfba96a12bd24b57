"""A render in parts: traced by whatever runs programs, joined to the bits of one process."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from nocturne_client.local.programs import need_program

from tests.system.renders import CORNELL
from tests.system.up import NOCTURNE

_FILM = ("--width", "40", "--height", "36", "--samples", "16")
_OPENJD = Path(sys.executable).with_name("openjd")


def _nocturne(*words: str | Path) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([NOCTURNE, *words], check=False, capture_output=True, text=True)


def _scene(folder: Path, direction: str) -> Path:
    """The Cornell box; where photons come from the lamp alone, a meter on its floor."""
    document: dict[str, Any] = json.loads(CORNELL.read_text())
    floor = {"position": [0.278, 0.001, 0.279], "normal": [0, 1, 0], "up": [0, 0, 1], "height": 0.4}
    if direction == "forward":
        document["sensor"] = {"type": "irradiance_meter", **floor}
    document["tracing"] = {"direction": direction}
    scene = folder / f"{direction}.json"
    scene.write_text(json.dumps(document))
    return scene


def _trace(job: Path, part: int, parts: int) -> "subprocess.CompletedProcess[str]":
    files = [f"{job}/scene.pb", "--schedule", f"{job}/schedule.pb", "--blobs", f"{job}/blobs", "--quiet"]
    program = str(need_program("nocturne-trace"))
    command = [program, *files, "--part", f"{part},{parts}", "-o", f"{job}/sums"]
    return subprocess.run(command, check=False, capture_output=True, text=True)


@pytest.mark.parametrize("direction", ["adjoint", "forward", "both"])
def test_parts_joined_are_the_image_of_one_process(direction: str, tmp_path: Path) -> None:
    scene, job, alone = _scene(tmp_path, direction), tmp_path / "job", tmp_path / "alone.exr"
    bands = ("--bands", "400:700:100")
    assert _nocturne("openjd", scene, "-o", job, "--parts", "3", *_FILM, *bands).returncode == 0
    for part in (2, 0, 1):
        assert _trace(job, part, 3).returncode == 0
    tiles = 0 if direction == "forward" else 4
    assert (len([*(job / "sums").iterdir()]) > tiles) == (direction != "adjoint")
    assert _nocturne("join", job, "-o", tmp_path / "joined.exr").returncode == 0
    assert _nocturne("render", scene, "-o", alone, *_FILM, *bands).returncode == 0
    assert (tmp_path / "joined.exr").read_bytes() == alone.read_bytes()


def test_what_is_there_is_not_traced_again_and_what_is_not_this_jobs_is_refused(tmp_path: Path) -> None:
    job, other = tmp_path / "job", tmp_path / "other"
    for folder, samples in ((job, "16"), (other, "8")):
        words = ("--parts", "2", "--width", "40", "--height", "36", "--samples", samples)
        assert _nocturne("openjd", CORNELL, "-o", folder, *words).returncode == 0
    assert _trace(job, 0, 2).returncode == 0
    missing = _nocturne("join", job, "-o", tmp_path / "joined.exr")
    assert (missing.returncode, "a part has not been traced" in " ".join(missing.stderr.split())) == (2, True)
    before = {file: file.stat().st_mtime_ns for file in (job / "sums").iterdir()}
    assert _trace(job, 0, 2).returncode == 0
    assert {file: file.stat().st_mtime_ns for file in (job / "sums").iterdir()} == before
    (other / "sums").mkdir()
    (other / "sums" / "0.sums").write_bytes((job / "sums" / "0.sums").read_bytes())
    refused = _trace(other, 0, 2)
    assert (refused.returncode, "is of another scene or schedule" in refused.stderr) == (2, True)
    cut = job / "sums" / "0.sums"
    cut.write_bytes(cut.read_bytes()[:-8])
    assert "has not the size" in _trace(job, 0, 2).stderr
    assert "0 <= K < N" in _trace(job, 2, 2).stderr


def test_open_job_description_runs_it(tmp_path: Path) -> None:
    job = tmp_path / "job"
    assert _nocturne("openjd", CORNELL, "-o", job, "--parts", "2", *_FILM).returncode == 0
    template = job / "template.json"
    checked = subprocess.run([_OPENJD, "check", template], check=False, capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout
    programs = [f"Trace={need_program('nocturne-trace')}", f"Nocturne={NOCTURNE}", f"Folder={job}"]
    parameters = [word for each in programs for word in ("--job-param", each)]
    run = [str(_OPENJD), "run", str(template), "--step", "Join", "--run-dependencies", *parameters]
    ran = subprocess.run(run, check=False, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout
    assert _nocturne("render", CORNELL, "-o", tmp_path / "alone.exr", *_FILM).returncode == 0
    assert (job / "image.exr").read_bytes() == (tmp_path / "alone.exr").read_bytes()
    assert (job / "image.png").exists()
