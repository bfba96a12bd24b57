"""nocturne-trace by many seeds: each image equals the one of a scene with that seed."""

import subprocess
from pathlib import Path

import pytest
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.programs import need_program

from tests.system.renders import CORNELL

pytestmark = pytest.mark.system


def _trace(compiled: CompiledFolder, output: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [need_program("nocturne-trace"), compiled.scene, "--schedule", compiled.schedule]
    command += ["--blobs", compiled.blobs, "-o", output, "--quiet"]
    words = [*map(str, command), *options]
    return subprocess.run(words, capture_output=True, text=True, check=False)


def _compiled(folder: Path, seed: int) -> CompiledFolder:
    folder.mkdir()
    return compile_to(CORNELL, folder, 20, 16, 8, seed=seed)


def test_images_by_seeds_are_those_of_scenes_with_them(tmp_path: Path) -> None:
    assert _trace(_compiled(tmp_path / "any", 7), tmp_path / "{seed}.exr", "--seeds", "2").returncode == 0
    for seed in (1, 2):
        own = tmp_path / f"own{seed}.exr"
        assert _trace(_compiled(tmp_path / str(seed), seed), own).returncode == 0
        assert (tmp_path / f"{seed}.exr").read_bytes() == own.read_bytes()
    assert (tmp_path / "1.exr").read_bytes() != (tmp_path / "2.exr").read_bytes()


def test_an_output_of_one_name_is_refused(tmp_path: Path) -> None:
    done = _trace(_compiled(tmp_path / "any", 7), tmp_path / "image.exr", "--seeds", "2")
    assert done.returncode == 2
    assert "has no {seed}" in done.stderr
    assert not (tmp_path / "image.exr").exists()
