"""`nocturne render`: one scene on this machine, without a service."""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import numpy as np
import OpenEXR
from nocturne.v1 import job_pb2
from nocturne_coordinator.output.images import FINAL_COMPRESSION, write_preview
from nocturne_scene.compare.images import read_picture
from nocturne_scene.layers import NO_LAYERS, read_layers
from rich.progress import Progress

from nocturne_client.console import ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.image_error import ImageError, image_error
from nocturne_client.local.local_stop import LocalStop
from nocturne_client.local.programs import need_program
from nocturne_client.outputs import check_output, put

_PERCENT = re.compile(r"\s*([0-9.]+) %")


@dataclass(frozen=True)
class LocalRender:
    """The scene to be rendered, and how."""

    scene: Path
    outputs: Sequence[Path]
    """Names that end in .exr or .png, or devices, which get the EXR."""
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
    """Names of layers in addition to those made without being asked for; see nocturne_scene.layers."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """Of the scene document; see nocturne_scene.document.changes."""
    name: str = ""
    """The scene's name for people, such as the file that was imported; empty: by its document."""


def render_scene(asked: LocalRender) -> None:
    """Compiles and traces a scene into images, with a progress bar; says its error at the end.

    Raises NocturneClientError, before anything is traced where an output can't be written.
    """
    program = need_program("nocturne-trace")
    check_outputs(asked.outputs)
    if asked.statistics is not None:
        check_output(asked.statistics)
    with tempfile.TemporaryDirectory(prefix="nocturne-") as folder:
        film = asked.width, asked.height, asked.samples
        name = asked.name or str(asked.scene)
        compiled = compile_to(asked.scene, Path(folder), *film, asked.seed, asked.layers, asked.changes, name)
        for line in compiled.said():
            ERRORS.print(line, markup=False, soft_wrap=True)
        image = Path(folder) / "image.exr"
        command = [str(program), *_arguments(compiled, asked, image)]
        if asked.stop:
            sums = Path(folder) / "sums"
            schedule = job_pb2.RangeSchedule.FromString(compiled.schedule.read_bytes())
            stop = LocalStop(asked.stop, schedule)
            _trace([*command, "--ask-after-ranges", str(sums)], Path(name).name, stop, sums)
        else:
            _trace(command, Path(name).name)
        error = finish_image(image, compiled.layers, asked.outputs)
    said = str(error)
    if wanted := asked.stop.get("relative_error"):
        said += f" {wanted:.3%} was asked for."
    ERRORS.print(said, markup=False, soft_wrap=True)


def check_outputs(outputs: Sequence[Path]) -> None:
    """Raises NocturneClientError, before anything is traced, where one can't be written."""
    for path in outputs:
        check_output(path)
        if path.suffix.lower() not in _WRITERS and (path.is_file() or not path.exists()):
            raise NocturneClientError(f"{path}: expected a name that ends in {' or '.join(_WRITERS)}")


def finish_image(image: Path, layers: Path | None, outputs: Sequence[Path]) -> ImageError:
    """Gives the tracer's EXR the bytes of the service's, and writes it where it is to go."""
    error = image_error(image)
    write_as_the_service_does(image, error.error_warning, layers)
    for path in outputs:
        _write(image, path)
    return error


def _write(image: Path, output: Path) -> None:
    """Writes an EXR as what the name of an output asks for. Raises NocturneClientError, and keeps the EXR."""
    made = _WRITERS.get(output.suffix.lower(), _as_it_is)(image)
    try:
        put(made, output)
    except OSError as error:
        kept = Path(tempfile.mkdtemp(prefix="nocturne-image-")) / image.name
        shutil.copyfile(image, kept)
        raise NocturneClientError(f"{output}: {error.strerror}; the image is kept as {kept}") from error


def _as_it_is(image: Path) -> Path:
    return image


def _as_png(image: Path) -> Path:
    """A PNG next to an EXR, exposed as the service's previews are."""
    xyz = read_picture(image).xyz
    png = image.with_suffix(".png")
    write_preview(png, xyz, np.ones(xyz.shape[:2], dtype=np.uint32), FINAL_COMPRESSION)
    return png


_WRITERS: Mapping[str, Callable[[Path], Path]] = {".exr": _as_it_is, ".png": _as_png}


def _arguments(compiled: CompiledFolder, asked: LocalRender, image: Path) -> list[str]:
    files = [str(compiled.scene), "--schedule", str(compiled.schedule), "--blobs", str(compiled.blobs)]
    statistics = ["--statistics", str(asked.statistics)] if asked.statistics else []
    return [*files, "-o", str(image), "--threads", str(asked.threads), *statistics]


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
    without end."""
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


def write_as_the_service_does(image: Path, error_warning: str = "", layers: Path | None = None) -> None:
    """Writes the tracer's EXR again, so that it has the very bytes of the service's: with why its errors are
    not to be trusted, with layers, and compressed by the same library."""
    beside = read_layers(layers) if layers else NO_LAYERS
    with OpenEXR.File(str(image), separate_channels=True) as file:
        before = {name: channel.pixels for name, channel in file.channels().items()}
        header = {
            **file.header(),
            **({"nocturne:errorWarning": error_warning} if error_warning else {}),
            **beside.attributes,
        }
    header.pop("channels", None)
    # A sensor may have responses with such names: they go first.
    with OpenEXR.File(header, {**beside.channels, **before}) as file:
        file.write(str(image))
