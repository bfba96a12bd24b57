"""Photons and rays per second of the tracer, against a bare Embree loop over the same rays and tree."""

import json
import tempfile
from pathlib import Path
from typing import Any

from nocturne_client.local.compiled import compile_to

from bench.programs import bench_program
from bench.programs import run as run_program
from bench.report import Figures, Row, significant, spread, spread_text
from bench.scenes import BUMPY_SPHERES, CORNELL, prepare_meshes

SCENES = {"cornell": CORNELL, "bumpy_spheres": BUMPY_SPHERES}
AIMS = {"cornell": 0.6, "bumpy_spheres": 0.8}


def run(quick: bool) -> Figures:
    """One thread, thread CPU time; the ratio is taken in each round, between neighbours in time."""
    prepare_meshes()
    edge, samples, rounds = (64, 16, 3) if quick else (256, 16, 7)
    return {name: _scene(path, edge, samples, rounds) for name, path in SCENES.items()}


def rows(figures: Figures) -> list[Row]:
    """Ratio and rates of each scene."""
    table = []
    for name, aim in AIMS.items():
        of = figures[name]
        table.append(
            Row(f"{name}: rays/s, tracer / bare Embree", spread_text(of["ratio"]), f"at least {aim}")
        )
        rates = (
            f"{of['photons_per_second'] / 1e6:.2f} M photons/s, {of['rays_per_second'] / 1e6:.2f} M rays/s"
        )
        table.append(Row(f"{name}: one thread", f"{rates}, {of['rays_per_photon']:.2f} rays a photon"))
    return table


def _scene(path: Path, edge: int, samples: int, rounds: int) -> Figures:
    program = bench_program("nocturne-bench-traversal")
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        compiled = compile_to(path, Path(folder), edge, edge, samples)
        work = ["--edge", edge, "--samples", samples, "--rounds", rounds]
        said: dict[str, Any] = json.loads(
            run_program([program, compiled.scene, "--blobs", compiled.blobs, *work])
        )
    photons, rays = said["photons"], said["rays"]
    tracer_s, bare_s = spread(said["tracer_cpu_seconds"]), spread(said["bare_cpu_seconds"])
    pairs = zip(said["tracer_cpu_seconds"], said["bare_cpu_seconds"], strict=True)
    return {
        "photons": photons,
        "rays": rays,
        "rays_per_photon": significant(rays / photons),
        "hits_per_ray": significant(said["hits"] / rays),
        "photons_per_second": significant(photons / tracer_s["median"]),
        "rays_per_second": significant(rays / tracer_s["median"]),
        "bare_rays_per_second": significant(rays / bare_s["median"]),
        "ratio": spread([bare / tracer for tracer, bare in pairs]),
    }
