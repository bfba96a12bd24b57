"""Accuracy of sums: up to 1e9 samples of a pixel are added, in single and in double precision.

Samples are exponentially distributed 32-bit floats, added one after another, as a pixel's are; Nocturne adds
ranges of 4096 samples in double precision, merged in order. The truth is their sum in 80-bit floats. The
error must be small compared with the sum's own noise, 1 / sqrt(n) here. The tracer itself is asked for a
constant: its mean over more samples than a 32-bit float can count must be that constant.
"""

import math
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from nocturne_client.local.chart import Line, write_chart

from bench.programs import read_channels, trace_to
from bench.report import Figures, Row, results_folder, significant
from bench.scenes import Document, compile_film

CHART = "accumulation.svg"

_RANGE = 4096
_CHUNK = 256 * _RANGE
_SMALLEST = 1e-18
"""What an error of nothing is drawn as."""

_NM = 830.0 - 360.0


@dataclass(frozen=True)
class _Size:
    largest: int
    """Samples; reached by steps of ten from a million."""
    traced: int


def run(quick: bool) -> Figures:
    """Relative errors of sums by number of samples, and of the tracer's mean of a constant."""
    # 2^24 is where a 32-bit float that counts by ones stands still.
    size = _Size(10**7, 2**16) if quick else _Size(10**9, 2**24 + 2**20)
    points = _sums(size.largest)
    if not quick:
        _draw(points)
    return {"sums": points, "traced": {"samples": size.traced, "error": _traced(size.traced)}}


def rows(figures: Figures) -> list[Row]:
    """Errors compared with the noise."""
    table = []
    for point in figures["sums"]:
        told = ", ".join(f"{name} {point[name]:.2g}" for name in ("float32", "float64", "ours"))
        table.append(
            Row(f"{point['samples']:.0e} samples: error of a sum", told, f"ours {0.1 * point['noise']:.2g}")
        )
    traced = figures["traced"]
    what = f"the tracer's mean of a constant, {traced['samples']} samples: error"
    table.append(Row(what, f"{traced['error']:.2g}", "1.2e-7: EXRs hold 32-bit floats"))
    return table


def _sums(largest: int) -> list[Figures]:
    random = np.random.default_rng(1)
    single, double, ours = np.float32(0), np.float64(0), np.float64(0)
    truth = np.longdouble(0)
    count, points = 0, []
    step = 10**6
    while step <= largest:
        while count < step:
            part = min(_CHUNK, step - count)
            samples = random.exponential(size=part).astype(np.float32)
            single = np.cumsum(np.concatenate([[single], samples]), dtype=np.float32)[-1]
            double = np.cumsum(np.concatenate([[double], samples]), dtype=np.float64)[-1]
            ours = _merge(ours, samples)
            truth += np.sum(samples, dtype=np.longdouble)
            count += part
        points.append(
            {
                "samples": count,
                "noise": significant(1.0 / math.sqrt(count)),
                "float32": _error(single, truth),
                "float64": _error(double, truth),
                "ours": _error(ours, truth),
            }
        )
        step *= 10
    return points


def _merge(total: np.float64, samples: np.typing.NDArray[np.float32]) -> np.float64:
    """Ranges one after another, samples within them one after another; a last range may be shorter."""
    whole = samples.size // _RANGE * _RANGE
    ranges = [np.cumsum(samples[:whole].reshape(-1, _RANGE), axis=1, dtype=np.float64)[:, -1]]
    if whole < samples.size:
        ranges.append(np.cumsum(samples[whole:], dtype=np.float64)[-1:])
    merged: np.float64 = np.cumsum(np.concatenate([[total], *ranges]))[-1]
    return merged


def _error(value: np.floating, truth: np.longdouble) -> float:
    return significant(max(_SMALLEST, abs(float((np.longdouble(value) - truth) / truth))))


def _traced(samples: int) -> float:
    """One pixel that sees an even light: all samples are alike (uniform wavelengths, response 1)."""
    document: Document = {
        "nocturne": 1,
        "environment": {"radiance": 1.0},
        "sensor": {
            "type": "pinhole",
            "position": [0, 0, 0],
            "look_at": [0, 0, 1],
            "vertical_field_of_view_degrees": 10,
            "wavelengths": "uniform",
            "responses": {"grey": 1.0},
        },
        "surfaces": [{"shape": {"type": "sphere", "centre": [0, 0, -9], "radius": 1}, "kernel": _BLACK}],
    }
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        compiled = compile_film(document, Path(folder), 1, 1, samples)
        image = Path(folder) / "image.exr"
        trace_to(compiled, image)
        grey = float(read_channels(image, ["grey"]).item())
    return significant(abs(grey / _NM - 1.0))


_BLACK = {"type": "lambertian", "reflectance": 0}


def _draw(points: list[Figures]) -> None:
    lines = [
        Line(name, [(point["samples"], point[key]) for point in points])
        for name, key in (
            ("noise", "noise"),
            ("float32", "float32"),
            ("float64", "float64"),
            ("ours", "ours"),
        )
    ]
    write_chart(results_folder() / CHART, "Error of a sum over its samples", "samples", "error", lines)
