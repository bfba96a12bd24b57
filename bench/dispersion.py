"""Groups of four photons against one wavelength a photon, where a body is dispersive and where nothing is."""

import tempfile
from pathlib import Path

import numpy as np

from bench.errors import true_relmse
from bench.programs import Channel, trace
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_document, cornell, example

_Tracing = dict[str, str | int]

_ADJOINT: _Tracing = {"direction": "adjoint", "sharing": 1}
_BOTH: _Tracing = {"direction": "both", "sharing": 1}


def run(quick: bool) -> Figures:
    """Squared error times processor time of groups of four over that of single photons, for each scene."""
    edge, samples, seeds = (16, 16, 3) if quick else (64, 64, 12)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        scenes = {
            name: _scene(document, tracing, Path(folder) / name, edge, samples, seeds)
            for name, (document, tracing) in _scenes(Path(folder)).items()
        }
    return {"scenes": scenes}


def rows(figures: Figures) -> list[Row]:
    """Of X, Y and Z together; below 1 groups of four are better."""
    return [
        Row(f"{name}: squared error x time, four photons together / one", f"{of['ratio']:.3g}")
        for name, of in figures["scenes"].items()
    ]


def _scenes(folder: Path) -> dict[str, tuple[Document, _Tracing]]:
    gem = cornell()
    gem["surfaces"].append(
        {
            "shape": {"type": "sphere", "centre": [0.4, 0.06, -0.3], "radius": 0.06},
            "kernel": {"type": "dielectric", "index": "N-SF11"},
        }
    )
    prism = example("prism", folder / "prism")
    return {
        "cornell": (cornell(), _ADJOINT),
        "cornell with a glass ball": (gem, _ADJOINT),
        "the same, 16 pixels share": (gem, {**_ADJOINT, "sharing": 16}),
        "the same, both directions": (gem, _BOTH),
        "prism": (prism, _ADJOINT),
        "prism, both directions": (prism, _BOTH),
    }


def _scene(
    document: Document, tracing: _Tracing, folder: Path, edge: int, samples: int, seeds: int
) -> Figures:
    errors, times = {}, {}
    for together in (1, 4):
        images = []
        times[together] = 0.0
        for seed in range(seeds):
            choice = {**tracing, "photons_together": together, "seed": seed}
            compiled = compile_document(document, folder / f"{together}-{seed}", edge, samples, choice)
            traced = trace(compiled, threads=1)
            images.append(traced.xyz)
            times[together] += traced.tracing_cpu_s
        errors[together] = _relmse(np.array(images))
    return {
        "relmse": {str(together): significant(error) for together, error in errors.items()},
        "cpu_s": {str(together): significant(time) for together, time in times.items()},
        "ratio": significant(errors[4] * times[4] / (errors[1] * times[1])),
    }


def _relmse(images: Channel) -> float:
    """Of one image against the mean of all, shape (images, height, width, 3): X, Y and Z alike."""
    count = len(images)
    mean, nothing = images.mean(axis=0), np.zeros(images.shape[1:3])
    spread = [
        true_relmse(image[..., k], mean[..., k], nothing) * count / (count - 1)
        for image in images
        for k in range(3)
    ]
    return float(np.mean(spread))
