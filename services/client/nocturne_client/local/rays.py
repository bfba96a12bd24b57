"""`nocturne rays`: what leaves a lamp in a scene as a ray file."""

import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne.v1 import scene_pb2
from nocturne_scene.photometry import far_field, tm25

from nocturne_client.console import ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.goniometer import RAY_FILE, check_sensor
from nocturne_client.local.programs import need_program
from nocturne_client.outputs import check_output, put

MOST = 10_000_000
"""Photons; their rays take 160 bytes each while they are written."""

# Each photon is one ray.
_TRACING = {"tracing.direction": "forward", "tracing.photons_together": 1}


@dataclass(frozen=True)
class Asked:
    """The lamp to trace, and where the file goes."""

    scene: Path
    output: Path
    photons: int
    threads: int
    seed: int | None
    changes: Mapping[str, Any]


def write_rays(asked: Asked) -> None:
    """Traces photons from the luminaires, and writes those that leave the sphere of the intensity meter.
    Raises NocturneClientError."""
    if asked.output.suffix.lower() != RAY_FILE:
        raise NocturneClientError(f"{asked.output}: expected a name that ends in {RAY_FILE}")
    check_output(asked.output)
    check_sensor(asked.scene, asked.changes)
    with tempfile.TemporaryDirectory(prefix="nocturne-rays-") as folder:
        compiled = compile_to(
            asked.scene, Path(folder), 1, 1, 1, asked.seed, changes={**_TRACING, **asked.changes}
        )
        for line in compiled.said():
            ERRORS.print(line, markup=False, soft_wrap=True)
        rays = _traced(asked, compiled, Path(folder) / "rays")
        made = Path(folder) / asked.output.name
        try:
            tm25.write(made, rays)
            put(made, asked.output)
        except OSError as problem:
            raise NocturneClientError(f"{asked.output}: {problem.strerror}") from problem
    lumens = float(far_field.lumens_of(rays).sum())
    ERRORS.print(f"{len(rays.starts)} rays of {asked.photons} photons, {lumens:.5g} lm", markup=False)


def _traced(asked: Asked, compiled: CompiledFolder, file: Path) -> tm25.RayFile:
    words: list[str | Path] = [need_program("nocturne-trace"), compiled.scene, "-o", file, "--quiet"]
    words += ["--schedule", compiled.schedule, "--blobs", compiled.blobs]
    words += ["--rays", str(asked.photons), "--threads", str(asked.threads)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)  # noqa: S603
    if done.returncode != 0:
        raise NocturneClientError(f"{asked.scene}: {done.stderr.strip()}")
    found = np.fromfile(file, dtype="<f4").reshape(-1, 8)
    if not len(found):
        raise NocturneClientError(f"{asked.scene}: no photon leaves the sphere of the intensity meter")
    sensor = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes()).sensor
    # The file's z is gamma 0 and its x is C0, seen from the middle of the sphere.
    axes = np.array([_numbers(sensor.right), -_numbers(sensor.up), _numbers(sensor.forward)])
    starts = (found[:, :3] - _numbers(sensor.position)) @ axes.T
    directions = found[:, 3:6] @ axes.T
    texts = (
        "",
        "",
        "",
        "nocturne rays",
        "none: traced",
        "",
        "",
        f"{asked.photons} photons, {len(found)} rays",
    )
    rays = tm25.RayFile(
        starts.astype(np.float32),
        directions.astype(np.float32),
        found[:, 6],
        None,
        found[:, 7],
        texts=texts,
    )
    lumens = far_field.lumens_of(rays).astype(np.float32)
    return tm25.RayFile(rays.starts, rays.directions, rays.watts, lumens, rays.wavelengths, texts=texts)


def _numbers(vector: scene_pb2.Vector) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([vector.x, vector.y, vector.z])
