"""Error at equal samples: number sequences and wavelength sampling, against a long reference."""

import itertools
import statistics
import tempfile
from dataclasses import dataclass
from pathlib import Path

from bench.errors import true_relmse
from bench.programs import Traced, trace
from bench.report import Figures, Row, significant
from bench.scenes import compile_document, cornell

SEQUENCES = ("sobol", "independent")
WAVELENGTHS = ("response", "uniform")
_REFERENCE_SEED = 1000


@dataclass(frozen=True)
class _Size:
    edge: int
    reference_samples: int
    sample_counts: tuple[int, ...]
    seeds: int


def run(quick: bool) -> Figures:
    """relMSE of Y on the Cornell box, the mean over seeds; and CPU time a photon."""
    size = _Size(16, 2048, (16,), 1) if quick else _Size(128, 4096, (16, 64, 256), 2)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        reference = _trace(
            place, size.edge, size.reference_samples, "independent", "response", _REFERENCE_SEED
        )
        variants = []
        for samples, sequence, wavelengths in itertools.product(size.sample_counts, SEQUENCES, WAVELENGTHS):
            images = [
                _trace(place, size.edge, samples, sequence, wavelengths, seed) for seed in range(size.seeds)
            ]
            names = {"samples": samples, "sequence": sequence, "wavelengths": wavelengths}
            variants.append({**names, **_figures(images, reference)})
    return {"cornell": variants}


def rows(figures: Figures) -> list[Row]:
    """Ratios of relMSE: how many times more samples the other choice needs, where error falls as 1/n."""
    variants = figures["cornell"]
    by_key = {(each["samples"], each["sequence"], each["wavelengths"]): each["relmse"] for each in variants}
    table = []
    for samples in sorted({each["samples"] for each in variants}):
        others = {
            "independent / Sobol": by_key[samples, "independent", "response"],
            "uniform / response-drawn wavelengths": by_key[samples, "sobol", "uniform"],
        }
        default = by_key[samples, "sobol", "response"]
        table += [
            Row(f"cornell, {samples} samples: relMSE, {name}", f"{other / default:.3g}")
            for name, other in others.items()
        ]
    return table


def _figures(images: list[Traced], reference: Traced) -> Figures:
    truth, error = reference.xyz[..., 1], reference.y_error
    cpu_s = statistics.median(image.tracing_cpu_s / image.photons for image in images)
    return {
        "relmse": significant(
            statistics.fmean(true_relmse(image.xyz[..., 1], truth, error) for image in images)
        ),
        "cpu_us_per_photon": significant(1e6 * cpu_s),
    }


def _trace(place: Path, edge: int, samples: int, sequence: str, wavelengths: str, seed: int) -> Traced:
    folder = place / f"{sequence}-{wavelengths}-{samples}-{seed}"
    tracing = {"sequence": sequence, "seed": seed}
    compiled = compile_document(cornell(), folder, edge, samples, tracing, {"wavelengths": wavelengths})
    return trace(compiled)
