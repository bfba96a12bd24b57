"""How much of the error single pixels carry: glossy spheres under a sky with a small Sun, traced as the
pilot chooses for a long render.

relMSE of all pixels of many images over that without the worst of a thousand, each less the reference's own.
"""

import tempfile
from pathlib import Path

import numpy as np

from bench.errors import squared_errors
from bench.peer.contenders import Ours
from bench.report import Figures, Row, significant
from bench.scenes import compile_film
from bench.suite.references import THREADS, load
from bench.suite.scenes import SCENES

_SCENE = "glossy spheres"
_FOR_A_PILOT = 2**16
_WORST = 0.001
_AIM = 2.0


def run(quick: bool) -> Figures:
    """For some numbers of samples."""
    images = 3 if quick else 24
    scene = SCENES[_SCENE]
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        document = scene.document(place)
        reference = load(_SCENE, document).reference
        film = scene.film
        compiled = compile_film(document, place, film.width, film.height, _FOR_A_PILOT, place / "out")
        ours = Ours(compiled, film, THREADS)
        ratios = {}
        for samples in (32,) if quick else (128, 512, 2048):
            errors = np.sort(
                [
                    squared_errors(ours.frame(samples, seed).y, reference.y, reference.error)
                    for seed in range(images)
                ],
                axis=None,
            )
            kept = errors[: errors.size - max(1, round(_WORST * errors.size))]
            ratios[str(samples)] = significant(float(errors.sum() / kept.sum()))
    return {"images": images, "chosen": compiled.way, "ratios": ratios}


def rows(figures: Figures) -> list[Row]:
    """One for each number of samples."""
    return [
        Row(
            f"{_SCENE}, {samples} samples, {figures['images']} images: relMSE of all pixels / without the "
            "worst 0.1 %",
            f"{ratio:.3g}",
            f"at most {_AIM:g}",
        )
        for samples, ratio in figures["ratios"].items()
    ]
