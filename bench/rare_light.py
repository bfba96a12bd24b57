"""Whether errors of images hold where light is rare: forty scenes of small bright lights and of surfaces that
focus their light, by the defaults.

Several images are rendered, each with its own random numbers and its own pilot. The bench counts their
squares of 8 x 8 pixels for which the image does not warn of missing light, and how many of these hold the
truth in their interval. The truth is a longer image by photons from both directions. Photons from the
luminaires bring the focused light; the scene aims them at all surfaces that focus it, not a pilot, which may
have missed some. SCENES=words: only scenes in whose names these words are.
"""

import os
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_scene.compare.images import read_picture
from nocturne_scene.render_warnings import RenderWarning, WarningKind
from nocturne_scene.uncertainty import read_region

from bench.peer.contenders import FilmSize, Ours
from bench.programs import Channel, trace_to
from bench.rare_scenes import gatherers, rare_scenes
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film
from bench.suite.references import THREADS

_FILM, _SQUARE = FilmSize(64, 48), 8
_STUDENT = 2.365
"""Standard errors to each side of a 95 % interval of the mean of eight truths."""
AIM = 0.93
"""Part of the squares that must hold the truth."""
_SEED, _TRUTHS = 1000, 8
_AIMED = 0.9
"""Of the truth's photons from luminaires: a tenth leaves as the luminaires emit, so that no light is lost."""
_IMAGES = 5
"""Of 48 squares each: a part of 95 % of all is then known to 1.4 %."""


def run(quick: bool) -> Figures:
    """Of each scene and number of samples, the part of squares that hold the truth. BENCH=full has longer
    truths and more images."""
    full = os.environ.get("BENCH") == "full"
    counts = (16,) if quick else (16, 64, 256, 1024)
    truth, images = (64, 1) if quick else (2048, 4 * _IMAGES) if full else (128, _IMAGES)
    words = os.environ.get("SCENES", "")
    scenes = {name: scene for name, scene in rare_scenes().items() if words in name}
    chosen = dict(list(scenes.items())[::10]) if quick else scenes
    return {
        "truth_samples": truth * _TRUTHS,
        "images": images,
        "scenes": {name: _scene(scene, counts, truth, images) for name, scene in chosen.items()},
    }


def rows(figures: Figures) -> list[Row]:
    """For each number of samples how many scenes hold; those that don't by name."""
    scenes = figures["scenes"]
    table = []
    for samples in next(iter(scenes.values()), ()):
        wrong = [
            f"{name} ({found[samples]['trusted_held']:.0%})"
            for name, found in scenes.items()
            if not _is_right(found[samples])
        ]
        table.append(
            Row(
                f"rare light, {samples} samples: scenes of {len(scenes)} in which {AIM:.0%} of the squares "
                "that the image trusts hold the truth" + (f"; not: {', '.join(wrong)}" if wrong else ""),
                str(len(scenes) - len(wrong)),
                f"all {len(scenes)}",
            )
        )
    return table


def _is_right(found: Figures) -> bool:
    """That so much of the mean may be missing says of no square that it is wrong."""
    return bool(found["trusted_held"] >= AIM)


def _scene(scene: Document, counts: tuple[int, ...], truth_samples: int, images: int) -> Figures:
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        by_both = {
            **scene,
            "important_directions": gatherers(scene),
            "tracing": {"direction": "both", "sharing": 1, "aimed_emission": _AIMED},
        }
        long = Ours(
            compile_film(by_both, place, *_size(), truth_samples * _TRUTHS, place / "truth"), _FILM, THREADS
        )
        truths = np.array([_means(long.traced(truth_samples, _SEED + 1 + i).xyz) for i in range(_TRUTHS)])
        truth, truth_error = truths.mean(axis=0), truths.std(axis=0, ddof=1) / len(truths) ** 0.5
        return {
            str(samples): _together(
                [_image(scene, samples, seed, place, truth, truth_error) for seed in range(images)]
            )
            for samples in counts
        }


def _image(
    scene: Document, samples: int, seed: int, place: Path, truth: Channel, truth_error: Channel
) -> Figures:
    """Of one image's squares, which hold the truth and which it trusts."""
    seeded = {**scene, "tracing": {"seed": seed}}
    compiled = compile_film(seeded, place, *_size(), samples, place / f"{samples}-{seed}")
    image = place / "image.exr"
    trace_to(compiled, image, THREADS, [])
    means, errors = _readings(image)
    return {
        "held": np.abs(means - truth) <= np.sqrt(errors**2 + (_STUDENT * truth_error) ** 2),
        "trusted": _trusted(compiled.warnings),
        "mean": means.mean() / truth.mean(),
        "told": any(each.kind is WarningKind.MISSING_LIGHT for each in compiled.warnings),
        "way": compiled.way.partition(":")[0],
    }


def _together(images: list[Figures]) -> Figures:
    held, trusted = (np.concatenate([each[name] for each in images]) for name in ("held", "trusted"))
    return {
        "held": round(float(held.mean()), 4),
        "trusted": round(float(trusted.mean()), 4),
        "trusted_held": round(float(held[trusted].mean()), 4) if trusted.any() else 1.0,
        "mean": significant(float(np.mean([each["mean"] for each in images]))),
        "told": round(float(np.mean([each["told"] for each in images])), 4),
        "way": ", or ".join(sorted({str(each["way"]) for each in images})),
    }


def _size() -> tuple[int, int]:
    return _FILM.width, _FILM.height


def _squares() -> Iterator[tuple[slice, slice]]:
    for y in range(0, _FILM.height, _SQUARE):
        for x in range(0, _FILM.width, _SQUARE):
            yield slice(y, y + _SQUARE), slice(x, x + _SQUARE)


def _trusted(warnings: Sequence[RenderWarning]) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Of squares, those in no part of which light may be missing by what the image says."""
    trusted = np.ones((_FILM.height, _FILM.width), dtype=np.bool_)
    for part in (part for warning in warnings for part in warning.parts):
        trusted[part.pixels] = False
    return np.array([trusted[square].all() for square in _squares()])


def _means(xyz: Channel) -> Channel:
    return np.array([xyz[square][..., 1].mean() for square in _squares()])


def _readings(image: Path) -> tuple[Channel, Channel]:
    """Of squares: means of Y, and half of their 95 % intervals, as a person reads them."""
    moments = read_picture(image).moments
    if moments is None:
        raise ValueError(f"{image} tells no errors")
    means, errors = [], []
    for square in _squares():
        chosen = np.zeros(moments.samples.shape, dtype=np.bool_)
        chosen[square] = True
        reading = read_region(moments, chosen)
        if reading is not None:
            means.append(reading.mean[1])
            errors.append(reading.coverage_factor * reading.error[1])
    return np.array(means), np.array(errors)
