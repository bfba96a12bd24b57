"""`nocturne render`: one scene on this machine, without a service."""

import re
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from nocturne.v1 import job_pb2
from rich.progress import Progress

from nocturne_client.cli.output import ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.image_error import image_error
from nocturne_client.local.local_stop import LocalStop
from nocturne_client.local.programs import need_program
from nocturne_client.local.rewriting import add_layers, note_doubt

_PERCENT = re.compile(r"\s*([0-9.]+) %")


@dataclass(frozen=True)
class LocalRender:
    """What is to be rendered, and how."""

    scene: Path
    output: Path
    width: int
    height: int
    samples: int
    threads: int
    seed: int | None = None
    """Instead of the scene's own."""
    statistics: Path | None = None
    """Where counts and times go, as JSON."""
    stop: Mapping[str, Any] = field(default_factory=dict)
    """Of the service's conditions, relative_error and wall_seconds."""
    layers: Sequence[str] = ()
    """Names of layers; see nocturne_scene.layers."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """Of the scene document; see nocturne_client.changes."""


def render_scene(asked: LocalRender) -> None:
    """Compiles and traces a scene into an EXR, with a progress bar; says its error at the end.

    Raises NocturneClientError.
    """
    program = need_program("nocturne-trace")
    for path in filter(None, (asked.output, asked.statistics)):
        if not path.absolute().parent.is_dir():
            raise NocturneClientError(f"{path.absolute().parent}: no such folder")
    with tempfile.TemporaryDirectory(prefix="nocturne-") as folder:
        film = asked.width, asked.height, asked.samples
        compiled = compile_to(asked.scene, Path(folder), *film, asked.seed, asked.layers, asked.changes)
        for warning in compiled.warnings:
            ERRORS.print(f"warning: {warning}", markup=False, soft_wrap=True)
        if compiled.way:
            ERRORS.print(f"traced by {compiled.way}", markup=False, soft_wrap=True)
        command = [str(program), *_arguments(compiled, asked)]
        if asked.stop:
            sums = Path(folder) / "sums"
            schedule = job_pb2.RangeSchedule.FromString(compiled.schedule.read_bytes())
            stop = LocalStop(asked.stop, schedule)
            _trace([*command, "--ask-after-ranges", str(sums)], asked.scene.name, stop, sums)
        else:
            _trace(command, asked.scene.name)
        if compiled.layers:
            add_layers(asked.output, compiled.layers)
    error = image_error(asked.output)
    if error.doubt:
        note_doubt(asked.output, error.doubt)
    said = str(error)
    if wanted := asked.stop.get("relative_error"):
        said += f" {wanted:.3%} was asked for."
    ERRORS.print(said, markup=False, soft_wrap=True)


def _arguments(compiled: CompiledFolder, asked: LocalRender) -> list[str]:
    files = [str(compiled.scene), "--schedule", str(compiled.schedule), "--blobs", str(compiled.blobs)]
    statistics = ["--statistics", str(asked.statistics)] if asked.statistics else []
    return [*files, "-o", str(asked.output), "--threads", str(asked.threads), *statistics]


def _trace(command: list[str], name: str, stop: LocalStop | None = None, sums: Path | None = None) -> None:
    pipe = subprocess.PIPE if stop else None
    # Text mode reads the program's carriage returns as line ends.
    process = subprocess.Popen(  # noqa: S603
        command, stdin=pipe, stdout=pipe, stderr=subprocess.PIPE, text=True, errors="replace"
    )
    with process, ThreadPoolExecutor(1) as beside:
        answered = beside.submit(_answer, process, stop, sums) if stop and sums else None
        try:
            said = _show(process.stderr, name)
        except BaseException:
            process.terminate()
            raise
    if answered:
        answered.result()
    if process.returncode != 0:
        raise NocturneClientError(f"nocturne-trace failed ({process.returncode}): {said}")
    if said:
        ERRORS.print(said, markup=False)


def _answer(process: "subprocess.Popen[str]", stop: LocalStop, sums: Path) -> None:
    """Tells the program after each range whether it is to go on; ends it where that fails, as it would wait
    for ever."""
    try:
        for line in process.stdout or ():
            answer = "stop" if stop.is_met(int(line), sums) else "go"
            if process.stdin is not None:
                process.stdin.write(f"{answer}\n")
                process.stdin.flush()
    except BaseException:
        process.terminate()
        raise


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
