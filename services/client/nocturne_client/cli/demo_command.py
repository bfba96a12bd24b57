"""`nocturne demo`: the Cornell box, rendered by a service on this machine, and where to look."""

import math
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from nocturne_client.cli.output import ExitStatus
from nocturne_client.cli.up_commands import DataOfService, Port
from nocturne_client.cli.watching import follow
from nocturne_client.client import Client
from nocturne_client.console import ERRORS
from nocturne_client.contract import Progress
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Render

_EDGE, _SAMPLES = 512, 64
_MORE = 16
"""Times as many samples: their square root, 4, is what the error falls by."""
_START_S = 120.0
_LOOK_S = 0.2


@dataclass(frozen=True)
class DemoPlaces:
    """The service's data folder and port, and where the image goes."""

    data: Path
    port: int
    images: Path


def add_to(app: typer.Typer) -> None:
    """Adds the command to the program."""
    app.command()(demo)


def demo(
    data: DataOfService = None,
    port: Port = 7070,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FOLDER", help="Where image and picture go.")
    ] = Path("nocturne-demo"),
) -> None:
    """Start the service if none answers, render the Cornell box through it, and say where to look."""
    from nocturne_client.local.data import default_data_folder

    raise typer.Exit(_run(DemoPlaces((data or default_data_folder()).absolute(), port, output)))


def _run(places: DemoPlaces) -> ExitStatus:
    """Starts the service where none runs, renders, writes image and picture, and prints where they are."""
    url = f"http://127.0.0.1:{places.port}"
    if not _is_ready(places.port):
        _start(places)
    with Client(url) as client:
        render = client.submit(_scene(), width=_EDGE, height=_EDGE, samples=_SAMPLES)
        status = follow(client.watch(render.id), False)
        if status == ExitStatus.FAILED:
            return status
        places.images.mkdir(parents=True, exist_ok=True)
        image = places.images / "cornell.exr"
        client.download(render.id, "exr", image)
        client.download(render.id, "png", image.with_suffix(".png"))
        sys.stdout.write(report(client.get(render.id), image.absolute(), places) + "\n")
    return status


def _scene() -> Path:
    """From the wheel, or from the checkout."""
    from nocturne_client.local.programs import CHECKOUT

    packed = Path(str(files("nocturne_client"))) / "examples" / "cornell" / "scene.json"
    return packed if packed.exists() else CHECKOUT / "examples" / "cornell" / "scene.json"


def _is_ready(port: int) -> bool:
    from nocturne_client.local.probes import api_answers

    return api_answers(port, "/readyz?exclude=merging")


def _start(places: DemoPlaces) -> None:
    """The service goes on when this program ends."""
    places.data.mkdir(mode=0o700, parents=True, exist_ok=True)
    log = places.data / "service.log"
    command = ["up", "--data", str(places.data), "--port", str(places.port)]
    ERRORS.print("starting the service ...")
    with log.open("wb") as output:
        service = subprocess.Popen(  # noqa: S603
            [sys.executable, "-m", "nocturne_client", *command],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
            start_new_session=True,
        )
    end = time.monotonic() + _START_S
    while not _is_ready(places.port):
        if service.poll() is not None:
            raise NocturneClientError(f"the service stopped:\n{log.read_text().strip()}")
        if time.monotonic() > end:
            raise NocturneClientError(f"the service does not answer; see {log}")
        time.sleep(_LOOK_S)


def report(render: Render, image: Path, places: DemoPlaces) -> str:
    """Lines for first-time users; the picture lies next to `image`."""
    url = f"http://127.0.0.1:{places.port}"
    minutes = (_MORE - 1) * render.progress.cpu_seconds / (60.0 * len(os.sched_getaffinity(0)))
    film = f"{render.width} x {render.height} pixels"
    return f"""
Rendered: the Cornell box, {film} with {render.samples} samples each, from its measured spectra.

  picture, to look at:        {image.with_suffix(".png")}
  image, to measure:          {image}
                              (X, Y, Z with standard errors; Y is luminance in cd/m2)
  page, to explore it:        {url}/#/renders/{render.id}

{_error(render.progress, render.unit)}

A better one: {_MORE} times as many samples have a quarter of the error. The present samples are kept, the
rest takes {_duration(minutes)} on this machine; watch it on the page:

  {_where(places.port)}{_program()} extend {render.id} --samples {_MORE * render.samples}

The service goes on; end it with: {_program()} down --data {places.data}"""


def _program() -> str:
    """The command line as it can be called from here, whatever is in PATH."""
    called = Path(sys.argv[0]).absolute()
    return str(called.relative_to(Path.cwd()) if called.is_relative_to(Path.cwd()) else called)


def _error(progress: Progress, unit: str) -> str:
    """The error, in plain words."""
    error, mean, interval = progress.relative_error, progress.mean, 1.96 * progress.mean_error
    if not error:
        return "How far the image is off is not known yet."
    digits = max(0, 1 - math.floor(math.log10(interval))) if interval > 0.0 else 0
    lines = [
        f"Its error: a pixel is off by about {100.0 * error:.2g} % of its luminance, the grain that you see.",
        f"The mean of all is known much better: {mean:.{digits}f} +- {interval:.{digits}f} {unit} (95 %).",
    ]
    if progress.error_warning:
        lines += [
            "Both are estimates from the same samples, and may be too small:",
            f"{progress.error_warning} That is usual for a first look; more samples help.",
        ]
    return "\n".join(lines)


def _duration(minutes: float) -> str:
    return "less than a minute" if minutes < 1.0 else f"about {math.ceil(minutes)} minutes"


def _where(port: int) -> str:
    """The setting for the command line, if the service is not at the default address."""
    return "" if port == 7070 else f"NOCTURNE_URL=http://127.0.0.1:{port} "
