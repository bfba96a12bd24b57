"""One program for many scenes gives what a program for each gives, and outlives scenes that fail."""

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.programs import need_program

from tests.crossings import assets, methods
from tests.crossings import program as of_program
from tests.crossings.program import Failed, Program
from tests.crossings.scenes import scene
from tests.system.renders import CORNELL

pytestmark = pytest.mark.system

_WITH_A_PICTURE = 1
"""Seed of a scene under a picture of the sky, with which the image library is loaded."""


@pytest.fixture
def program() -> Iterator[Program]:
    made = Program()
    yield made
    made.close()


def _words(compiled: CompiledFolder, output: Path) -> list[object]:
    words: list[object] = [compiled.scene, "--schedule", compiled.schedule, "--blobs", compiled.blobs]
    return [*words, "-o", output, "--quiet", "--threads", 1]


def test_images_are_those_of_programs_of_their_own(tmp_path: Path, program: Program) -> None:
    """Two scenes by turns, in folders with blanks and quotes in their names."""
    folders = [tmp_path / name for name in ('a "box" for one', "the other's")]
    for folder in folders:
        folder.mkdir()
        assets.write(folder)
    made = scene(_WITH_A_PICTURE)
    compiled = [
        compile_to(CORNELL, folders[0], 12, 8, 8),
        methods.compiled(methods.methods_of(made)["plain"], made, folders[1], 8),
    ]
    for one in compiled:
        output = one.scene.with_name("own.exr")
        command = [need_program("nocturne-trace"), *_words(one, output)]
        subprocess.run([*map(str, command)], check=True)
    for one in (*compiled, *compiled):
        output = one.scene.with_name("among others.exr")
        program.run(_words(one, output))
        assert output.read_bytes() == output.with_name("own.exr").read_bytes()
        output.unlink()


def test_others_go_on_after_what_fails(tmp_path: Path, program: Program) -> None:
    compiled = compile_to(CORNELL, tmp_path, 8, 8, 2)
    words = _words(compiled, tmp_path / "image.exr")
    with pytest.raises(Failed, match=r"status 2: nocturne-trace: .*no \{seed\}"):
        program.run([*words, "--seeds", 2])
    with pytest.raises(Failed, match="status 105: --seeds"):
        program.run([*words, "--seeds", "many"])
    program.run(words)
    assert (tmp_path / "image.exr").exists()


def test_one_that_takes_too_long_ends(
    tmp_path: Path, program: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of_program, "CPU_LIMIT_S", 1)
    words = _words(compile_to(CORNELL, tmp_path, 512, 512, 4096), tmp_path / "image.exr")
    with pytest.raises(Failed, match="status -24"):
        program.run(words)
    program.run(_words(compile_to(CORNELL, tmp_path, 8, 8, 2), tmp_path / "image.exr"))
