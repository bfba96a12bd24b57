"""Means of whole images: Nocturne's compared with those of the renderer that a file is for."""

import math
import tempfile
import tomllib
from dataclasses import dataclass
from fnmatch import fnmatch
from fractions import Fraction
from itertools import count
from pathlib import Path
from subprocess import CalledProcessError

import numpy as np
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import Imported, ImportOptions
from nocturne_scene.formats.reading.scene_writer import FilmSettings
from numpy.typing import NDArray

from bench.peer.contenders import FilmSize, frames_of
from tests.mitsuba.renders import Batches

Values = NDArray[np.float64]

FORMAT = "Mitsuba 3"
BATCHES = 8
BOUND = 0.02
"""Of the means' ratio less one: what counts as the same light."""

# Of an image, all batches together, where the film's shape allows it.
_SAMPLES = 1_200_000
# Taken instead where the means are not known to this.
_MORE_SAMPLES = 10_000_000
_ERROR = 0.005
_PIXELS = 2_500
_SAME_SHAPE = Fraction(1, 1000)

_REASONS = Path(__file__).with_name("reasons.toml")
# Characters of a message that are shown.
_SHOWN = 300

# Integrators and materials that count with polarised light say so in their message.
_VARIANTS = ("scalar_spectral", "scalar_spectral_polarized")
_POLARIZED = "polariz"


class RefusedByPeer(Exception):
    """Mitsuba doesn't render a file: its message."""


@dataclass(frozen=True)
class Means:
    """X, Y, Z of both, in Mitsuba's unit, with standard errors."""

    ours: Values
    ours_error: Values
    theirs: Values
    theirs_error: Values

    @property
    def ratio(self) -> Values:
        """Ours over theirs."""
        return self.ours / self.theirs

    @property
    def error(self) -> Values:
        """Standard error of the ratio."""
        relative = np.hypot(self.ours_error / self.ours, self.theirs_error / self.theirs)
        return np.asarray(self.ratio * relative)

    @property
    def agree(self) -> bool:
        """Whether X, Y and Z are within the bound."""
        return bool(np.all(np.abs(self.ratio - 1) <= BOUND))


@dataclass(frozen=True)
class Row:
    """A file, and its outcome."""

    name: str
    means: Means | None
    told: str
    """What the importer lost, why the means are known to differ, or why there are none."""


def row(name: str, file: Path, root: Path, python: Path) -> Row:
    """Compares one file."""
    try:
        means, losses = compared(file, root, python)
    except InputError as error:
        return Row(name, None, f"refused: {error.problems[0].message}")
    except RefusedByPeer as error:
        return Row(name, None, f"not by Mitsuba: {error}".replace(f"{root}/", ""))
    reason = "" if means.agree else known_reason(name)
    return Row(name, means, "; ".join(filter(None, (reason, *losses))))


def known_reason(name: str) -> str:
    """Why the means of a file differ, where that is known."""
    known: list[dict[str, str]] = tomllib.loads(_REASONS.read_text())["reason"]
    return next((each["why"] for each in known if fnmatch(name, each["file"])), "")


def page(rows: list[Row]) -> str:
    """All files: first those whose means differ, last those without."""
    compared = [each for each in rows if each.means is not None]
    differ = [each for each in compared if each.means is not None and not each.means.agree]
    lines = [
        "# Means against Mitsuba's own renders",
        "",
        f"{len(compared)} files rendered by both: {len(compared) - len(differ)} within {BOUND:.0%} in "
        f"X, Y and Z, {len(differ)} beyond, {sum(not each.told for each in differ)} of them unexplained. "
        f"{len(rows) - len(compared)} not rendered by both.",
        "",
        f"Ours over theirs, less one, with the standard error of both together: spectral, on a film of some "
        f"{_PIXELS:,} pixels of the file's shape, with a box filter, {BATCHES} batches of independent "
        f"samples, {_SAMPLES:,} altogether, {_MORE_SAMPLES:,} where the error would be above {_ERROR:.1%}. "
        "Written by `python -m tests.corpus MIRRORS --means build/peers/bin/python -o PAGE.md`.",
        "",
        "| file | X | Y | Z | |",
        "| --- | --- | --- | --- | --- |",
    ]
    rest = [each for each in rows if each not in differ and each.means is not None]
    for each in (*differ, *rest):
        if each.means is not None:
            parts = zip(each.means.ratio, each.means.error, strict=True)
            cells = " | ".join(f"{ratio - 1:+.2%} ± {error:.2%}" for ratio, error in parts)
            lines.append(f"| {each.name} | {cells} | {_cell(each.told)} |")
    lines += ["", "| not compared | why |", "| --- | --- |"]
    lines += [f"| {each.name} | {_cell(each.told)} |" for each in rows if each.means is None]
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "/").replace("\n", " ")[:_SHOWN]


def small(film: FilmSettings) -> FilmSettings:
    """A film with few pixels, of the same shape to a thousandth."""
    shape = Fraction(film.width, film.height)
    near = next(
        fraction
        for fraction in map(shape.limit_denominator, count(1))
        if abs(fraction / shape - 1) <= _SAME_SHAPE
    )
    times = max(1, round(math.sqrt(_PIXELS / (near.numerator * near.denominator))))
    return FilmSettings(near.numerator * times, near.denominator * times)


def compared(file: Path, root: Path, python: Path) -> tuple[Means, tuple[str, ...]]:
    """Renders a Mitsuba file by both renderers; with what the importer lost.

    `python` is of an environment with Mitsuba.
    """
    with tempfile.TemporaryDirectory() as kept:
        folder = Path(kept)
        imported = import_scene(file, folder / "scene", ImportOptions(root, allow_missing=True))
        film = small(imported.film)
        scene = Imported(imported.document, film, imported.notes, imported.missing)
        for total in (_SAMPLES, _MORE_SAMPLES):
            samples = max(1, round(total / BATCHES / (film.width * film.height)))
            theirs = _theirs(file, film, samples, python, folder)
            ours = Batches(scene, folder / f"compiled {total}", BATCHES, samples).means()
            found = Means(*_of(ours), *_of(theirs))
            if found.error.max() <= _ERROR:
                break
    losses = tuple(each.message for each in imported.missing)
    return found, losses


def _theirs(file: Path, film: FilmSettings, samples: int, python: Path, folder: Path) -> Values:
    size = FilmSize(film.width, film.height)
    refused = ""
    for variant in _VARIANTS:
        try:
            frames = frames_of(python, file, samples, BATCHES, folder, variant=variant, film=size)
            return np.asarray(frames[..., :3].mean(axis=(1, 2)))
        except CalledProcessError as error:
            refused = error.stderr
            if _POLARIZED not in refused:
                break
    raise RefusedByPeer(refused.strip().splitlines()[-1])


def _of(batches: Values) -> tuple[Values, Values]:
    """Mean and its standard error."""
    return batches.mean(axis=0), batches.std(axis=0, ddof=1) / math.sqrt(len(batches))
