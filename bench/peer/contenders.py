"""Those who are compared: each gives frames of the same scene."""

import json
import select
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Protocol

import numpy as np
from nocturne.v1 import scene_pb2
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder
from nocturne_client.local.exporting import export_to
from nocturne_scene.film import Film
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT
from nocturne_scene.scene_ranges import schedule_of

from bench.peer.install import Installed
from bench.programs import BASELINE, Channel, Traced, bench_program, trace

SERVER = Path(__file__).with_name("mitsuba_server.py")

SAMPLERS = ("multijitter", "independent")
"""The first serves it best."""
PARTICLES = "particles"
"""Its particle tracer, which knows no media and fills no pixels that show luminaires in mirrors."""

_PATIENCE_S = 60.0
"""For an answer: some scenes make it compile kernels for hours."""


_BATCH_THREADS, _BATCH_PATIENCE_S = 2, 900.0
"""For many images of a scene, of which none is timed."""


@dataclass(frozen=True)
class Frame:
    """An image and its cost."""

    y: Channel
    """Luminance, cd/m2."""
    cpu_s: float
    """All threads, without loading the scene, compiling it and writing the image."""


class Contender(Protocol):
    """A renderer with its choices made."""

    def frame(self, samples: int, seed: int) -> Frame:
        """Renders the scene with so many samples per pixel; other seeds give independent noise."""


@dataclass(frozen=True)
class FilmSize:
    """Pixels."""

    width: int
    height: int


class Ours:
    """nocturne-trace, or nocturne-baseline."""

    def __init__(
        self, compiled: CompiledFolder, film: FilmSize, threads: int, baseline: Sequence[object] = ()
    ) -> None:
        """`baseline`: options of nocturne-baseline, where that is to trace."""
        self._compiled = compiled
        self._film = film
        self._threads = threads
        self._baseline = baseline
        self._scene = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes())

    def frame(self, samples: int, seed: int) -> Frame:
        """As Contender says."""
        traced = self.traced(samples, seed)
        return Frame(traced.xyz[..., 1], traced.tracing_cpu_s)

    def traced(self, samples: int, seed: int) -> Traced:
        """The same with all that the image says."""
        folder = self._compiled.scene.parent
        used = replace(self._compiled, scene=folder / "seeded.pb", schedule=folder / "seeded-schedule.pb")
        self._scene.tracing.seed = seed
        used.scene.write_bytes(self._scene.SerializeToString(deterministic=True))
        schedule = schedule_of(self._scene, self._film.width, self._film.height, samples)
        used.schedule.write_bytes(schedule.SerializeToString(deterministic=True))
        if not self._baseline:
            return trace(used, self._threads)
        return trace(used, self._threads, self._baseline, bench_program(BASELINE))


class Mitsuba:
    """Mitsuba 3 with one of its samplers, in a process that serves all of them."""

    def __init__(
        self, process: "subprocess.Popen[str]", sampler: str, image: Path, integrator: str = ""
    ) -> None:
        """With the scene's own integrator unless another is named."""
        self._process = process
        self._sampler = sampler
        self._integrator = integrator
        self._image = image
        self._compiled_for: set[int] = set()

    def frame(self, samples: int, seed: int) -> Frame:
        """As Contender says. A new number of samples compiles kernels, so that frame is rendered twice."""
        if samples not in self._compiled_for:
            self._compiled_for.add(samples)
            self._ask(samples, seed)
        cpu_s = self._ask(samples, seed)
        return Frame(np.load(self._image)[..., 1] * CANDELAS_PER_UNIT, cpu_s)

    def _ask(self, samples: int, seed: int) -> float:
        request = {
            "sampler": self._sampler,
            "integrator": self._integrator,
            "samples": samples,
            "seed": seed,
            "image": str(self._image),
        }
        to_it, from_it = _pipe(self._process.stdin), _pipe(self._process.stdout)
        try:
            to_it.write(json.dumps(request) + "\n")
            to_it.flush()
        except BrokenPipeError:
            pass
        if not select.select([from_it], [], [], _PATIENCE_S)[0]:
            self._process.kill()
            raise NocturneClientError(f"Mitsuba gave no image within {_PATIENCE_S:g} s")
        answer = from_it.readline()
        if not answer:
            raise NocturneClientError(
                f"Mitsuba ended with status {self._process.wait()}; see its words above"
            )
        cpu_s: float = json.loads(answer)["cpu_s"]
        return cpu_s


@contextmanager
def mitsuba(
    installed: Installed, document: Path, folder: Path, film: FilmSize, threads: int
) -> Iterator[dict[str, Mitsuba]]:
    """Starts it with the scene, exported into the folder; gives contenders: SAMPLERS and PARTICLES."""
    exported = export_to(document, folder, "mitsuba", Film(film.width, film.height, 1))
    with mitsuba_of(installed, exported.scene, folder, threads) as found:
        yield found


@contextmanager
def mitsuba_of(installed: Installed, scene: Path, folder: Path, threads: int) -> Iterator[dict[str, Mitsuba]]:
    """Starts it with a scene in its own format, whose sampler is `$sampler`; `folder` is for images."""
    process = subprocess.Popen(
        [
            str(installed.python),
            "-P",
            str(SERVER),
            installed.variant,
            str(threads),
            str(scene),
            *SAMPLERS,
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=installed.environment,
    )
    try:
        image = folder / "image.npy"
        yield {sampler: Mitsuba(process, sampler, image) for sampler in SAMPLERS} | {
            PARTICLES: Mitsuba(process, SAMPLERS[0], image, "ptracer")
        }
    finally:
        process.kill()
        process.communicate()


def frames_of(
    python: Path,
    scene: Path,
    samples: int,
    count: int,
    folder: Path,
    *,
    variant: str = "scalar_spectral",
    film: FilmSize | None = None,
) -> Channel:
    """XYZ by Mitsuba, in its unit, of seeds from 0, shape (count, height, width, 3), on the scene's film or
    another one; `folder` is for images. CalledProcessError with its complaint where it refuses the scene."""
    sampler = "independent"
    images = [folder / f"frame-{seed}.npy" for seed in range(count)]
    asked = {"sampler": sampler, "integrator": "", "samples": samples}
    lines = [json.dumps({**asked, "seed": seed, "image": str(image)}) for seed, image in enumerate(images)]
    options = ["--film", film.width, film.height] if film else []
    command = [python, "-P", SERVER, "--strict", *options, "--", variant, _BATCH_THREADS, scene, sampler]
    subprocess.run(
        [str(word) for word in command],
        input="\n".join(lines),
        capture_output=True,
        text=True,
        check=True,
        timeout=_BATCH_PATIENCE_S,
    )
    return np.stack([np.load(image).astype(np.float64) for image in images])


def _pipe(stream: IO[str] | None) -> IO[str]:
    if stream is None:
        raise ValueError("the process was started without pipes")
    return stream
