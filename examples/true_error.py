"""The README's second picture: a short render, the error that it states, and its true error.

python -m examples.true_error            # half a minute of processor time

The true error is the distance to a reference of 8 times the samples and another seed. It writes
docs/images/true_error.webp and docs/images/true_error.json, whose figures stand under the picture.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from nocturne.v1 import job_pb2
from nocturne_scene.compare.images import Picture, read_picture
from numpy.typing import NDArray

from examples.gallery import EXAMPLES, THREADS, shown, write_webp

PICTURE = EXAMPLES.parent / "docs" / "images" / "true_error.webp"
EDGE, SAMPLES, TIMES = 96, 64, 8
ENLARGED = 5
"""Screen pixels for a pixel."""

FULL = 0.2
"""Relative error that is shown as white."""

Values = NDArray[np.float64]


def main() -> None:
    """Render, compare, write."""
    with tempfile.TemporaryDirectory(prefix="nocturne-true-error-") as name:
        render, reference = (_render(Path(name), *each) for each in ((1, SAMPLES), (2, TIMES * SAMPLES)))
    stated, true = errors(render, reference)
    maps = [np.repeat(np.clip(255 * each / FULL, 0, 255)[..., None], 3, axis=-1) for each in (stated, true)]
    light = (0.3127, 0.3290)
    row = np.concatenate([shown(render.xyz, 0.0, light), *(each.astype(np.uint8) for each in maps)], axis=1)
    enlarged = row.repeat(ENLARGED, axis=0).repeat(ENLARGED, axis=1)
    write_webp(PICTURE, np.ascontiguousarray(enlarged), 200_000)
    figures = {
        "samples": SAMPLES,
        "stated": float(np.sqrt(np.mean(stated**2))),
        "true": float(np.sqrt(np.mean(true**2))),
        "within": float(np.mean(true < 1.96 * stated)),
        "engine": int(job_pb2.ENGINE_CURRENT),
    }
    PICTURE.with_suffix(".json").write_text(json.dumps(figures, indent=1) + "\n")


def errors(render: Picture, reference: Picture) -> tuple[Values, Values]:
    """Of each pixel of Y, relative as docs/glossary.md has it: the stated standard error, and the distance to
    the reference."""
    if render.y_error is None:
        raise ValueError("the render does not state its errors")
    y, truth = render.xyz[..., 1], reference.xyz[..., 1]
    level = np.sqrt(truth**2 + 0.01 * truth.mean() ** 2)
    return render.y_error / level, np.abs(y - truth) / level


def _render(folder: Path, seed: int, samples: int) -> Picture:
    image = folder / f"{seed}.exr"
    size = ["--width", str(EDGE), "--height", str(EDGE), "--samples", str(samples), "--seed", str(seed)]
    threads = ["--threads", os.environ.get(THREADS, "0")]
    scene = EXAMPLES / "cornell" / "scene.json"
    command = [
        sys.executable,
        "-m",
        "nocturne_client",
        "render",
        str(scene),
        "-o",
        str(image),
        *size,
        *threads,
    ]
    subprocess.run(command, check=True, capture_output=True)  # noqa: S603
    return read_picture(image)


if __name__ == "__main__":
    main()
