"""`nocturne render`: one scene on this machine, without a service."""

import re
import subprocess
import tempfile
from pathlib import Path
from typing import IO

from rich.progress import Progress

from nocturne_client.cli.output import ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.programs import need_program

_PERCENT = re.compile(r"\s*([0-9.]+) %")


def render_scene(scene: Path, output: Path, width: int, height: int, samples: int, threads: int) -> None:
    """Compiles and traces `scene` into the EXR `output`, with a progress bar. Raises NocturneClientError."""
    program = need_program("nocturne-trace")
    if not output.absolute().parent.is_dir():
        raise NocturneClientError(f"{output.absolute().parent}: no such folder")
    with tempfile.TemporaryDirectory(prefix="nocturne-") as folder:
        compiled = compile_to(scene, Path(folder), width, height, samples)
        _trace([str(program), *_arguments(compiled, output, threads)], scene.name)


def _arguments(compiled: CompiledFolder, output: Path, threads: int) -> list[str]:
    files = [str(compiled.scene), "--schedule", str(compiled.schedule), "--blobs", str(compiled.blobs)]
    return [*files, "-o", str(output), "--threads", str(threads)]


def _trace(command: list[str], name: str) -> None:
    # Text mode reads the program's carriage returns as line ends.
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, errors="replace")  # noqa: S603
    with process:
        try:
            said = _show(process.stderr, name)
        except BaseException:
            process.terminate()
            raise
    if process.returncode != 0:
        raise NocturneClientError(f"nocturne-trace failed ({process.returncode}): {said}")
    if said:
        ERRORS.print(said, markup=False)


def _show(lines: IO[str] | None, name: str) -> str:
    """Shows percentages as a bar; gives the last of all other lines."""
    said = ""
    with Progress(console=ERRORS) as bar:
        task = bar.add_task(name, total=100.0)
        for line in lines or ():
            percent = _PERCENT.match(line)
            if percent:
                bar.update(task, completed=float(percent[1]))
            elif line.strip():
                said = line.strip()
    return said
