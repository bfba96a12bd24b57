"""`nocturne validate`: renders scenes whose readings are known, and says how far they are off."""

import json
import os
import platform
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Any

from nocturne.v1 import job_pb2
from nocturne_scene.compare.images import read_picture
from nocturne_scene.uncertainty import RegionReading, read_region
from nocturne_scene.validation.cases import Quantity, Scene, Suite
from nocturne_scene.validation.suites import SUITES
from nocturne_scene.validation.verdict import Reading, Verdict, verdict

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.programs import need_program

EVERY = 8
"""Of the scenes of a suite, which `--quick` takes."""


@dataclass(frozen=True)
class Validation:
    """Readings, and the engine and machine that made them."""

    readings: tuple[Reading, ...]
    engine: int
    machine: str
    seconds: float
    quick: bool
    seed: int
    when: datetime

    @property
    def verdict(self) -> Verdict:
        """Of all readings."""
        return verdict(self.readings)

    def of(self, suite: str) -> list[Reading]:
        """The readings of a suite."""
        return [each for each in self.readings if each.suite == suite]


def chosen_suites(names: Sequence[str]) -> list[Suite]:
    """By name; all without. Raises NocturneClientError."""
    known = {suite.name: suite for suite in SUITES}
    for name in names:
        if name not in known:
            raise NocturneClientError(f"no suite named {name}; expected one of {', '.join(known)}")
    return [known[name] for name in names] if names else list(SUITES)


def validate(
    suites: Sequence[Suite], *, quick: bool, seed: int, threads: int, told: Callable[[Reading], None]
) -> Validation:
    """Renders all scenes, several at once; `told` hears of each reading in order."""
    program, begin = need_program("nocturne-trace"), time.monotonic()
    readings: list[Reading] = []
    scenes = [
        (suite.name, scene) for suite in suites for scene in list(suite.scenes())[:: EVERY if quick else 1]
    ]
    with ThreadPoolExecutor(threads) as pool:
        for found in pool.map(lambda each: _read(program, each[0], each[1], seed), scenes):
            for reading in found:
                readings.append(reading)
                told(reading)
    return Validation(
        tuple(readings),
        int(job_pb2.ENGINE_CURRENT),
        _machine(),
        time.monotonic() - begin,
        quick,
        seed,
        datetime.now(UTC),
    )


def _read(program: Path, suite: str, scene: Scene, seed: int) -> list[Reading]:
    """Traced with independent samples: Sobol's are more even than their errors say, which hides faults. Each
    scene has its own random numbers, or deviations would be alike."""
    own = int.from_bytes(sha256(f"{seed} {suite} {scene.values[0].name}".encode()).digest()[:8], "big")
    tracing = {**scene.document.get("tracing", {}), "sequence": "independent", "seed": own}
    with tempfile.TemporaryDirectory(prefix="nocturne-") as name:
        folder = Path(name)
        path, image = folder / "scene.json", folder / "image.exr"
        path.write_text(json.dumps({**scene.document, "tracing": tracing}))
        compiled = compile_to(path, folder, *scene.film, scene.samples, name=scene.values[0].name)
        command: list[str | Path] = [program, compiled.scene, "--blobs", compiled.blobs]
        command += ["--schedule", compiled.schedule, "-o", image, "--threads", "1", "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
        if done.returncode != 0:
            raise NocturneClientError(f"{scene.values[0].name}: {done.stderr.strip()}")
        picture = read_picture(image)
        region = read_region(picture.moments) if picture.moments is not None else None
        if region is None:
            raise NocturneClientError(f"{scene.values[0].name}: the image has no samples")
        return list(_readings(suite, scene, region, picture.names))


def _readings(suite: str, scene: Scene, region: RegionReading, names: Sequence[str]) -> Iterator[Reading]:
    for value in scene.values:
        found, error = _found(value.quantity, region, names)
        error *= abs(value.scale)
        yield Reading(suite, value, value.of(found), error, region.coverage_factor * error)


def _found(quantity: Quantity, region: RegionReading, names: Sequence[str]) -> tuple[float, float]:
    if quantity in ("u'", "v'"):
        index = int(quantity == "v'")
        return region.chromaticity[index], region.chromaticity_error[index]
    index = list(names).index(quantity)
    return region.mean[index], region.error[index]


def _machine() -> str:
    """Processor, how many of them, and the system."""
    model = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        model = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{model}, {len(os.sched_getaffinity(0))} processors, {platform.system()} {platform.release()}"


def as_json(found: Validation) -> dict[str, Any]:
    """All of it, with a row for each value."""
    return {
        "engine": found.engine,
        "machine": found.machine,
        "time": found.when.isoformat(timespec="seconds"),
        "seconds": round(found.seconds, 1),
        "quick": found.quick,
        "seed": found.seed,
        "verdict": verdict_as_json(found.verdict),
        "suites": {
            name: verdict_as_json(verdict(found.of(name)))
            for name in dict.fromkeys(r.suite for r in found.readings)
        },
        "values": [
            {
                "suite": each.suite,
                "name": each.value.name,
                "truth": each.value.truth,
                "value": each.found,
                "standard_error": each.error,
                "half_interval_95": each.half_interval,
                "z": each.z,
                "source": each.value.source,
            }
            for each in found.readings
        ],
    }


def verdict_as_json(found: Verdict) -> dict[str, Any]:
    """Without NaN, which JSON lacks."""
    numbers = {name: None if value != value else value for name, value in vars(found).items()}
    return {**numbers, "good": found.is_good}
