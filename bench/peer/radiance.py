"""Radiance in a separate environment: its programs, scenes of ours in its language, readings at points."""

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path

import numpy as np

from bench.programs import Channel, children_cpu_s
from bench.report import Skipped
from bench.scenes import Document

# bench/peer/radiance.py, two folders down from the checkout
_FOLDER = Path(__file__).resolve().parents[2] / "build" / "radiance"
_PYTHON = _FOLDER / "bin" / "python"
VERSION = "1.3.1"
"""Of pyradiance, which has Radiance's programs."""

_EFFICACY = 179.0
"""lm/W, by which Radiance makes photometric of radiometric."""

_OVERCAST = 2
"""Of skybright.cal: L = (1 + 2 sin(elevation)) / 3 of the zenith's."""


@dataclass(frozen=True)
class Radiance:
    """A scene, ready to be traced."""

    programs: Path
    library: Path
    octree: Path

    def readings(self, points: Sequence[tuple[float, float, float]], options: str) -> tuple[Channel, float]:
        """Illuminances of horizontal planes there, lx, and processor seconds."""
        text = "".join(f"{x} {y} {z} 0 0 1\n" for x, y, z in points)
        before = children_cpu_s()
        command = [self.programs / "rtrace", "-h", "-I", "-w", *options.split(), self.octree]
        found = _run([str(word) for word in command], text, self.library)
        cpu_s = children_cpu_s() - before
        rgb = np.array([[float(each) for each in line.split()] for line in found.splitlines()])
        return _EFFICACY * rgb[:, 1], cpu_s


def install() -> tuple[Path, Path]:
    """Folders of its programs and of its library; Skipped where it can't be installed."""
    if not _PYTHON.exists():
        print(f"bench: installing pyradiance {VERSION} into {_FOLDER}", file=sys.stderr)
        _need([sys.executable, "-m", "venv", "--clear", str(_FOLDER)])
    packages = list((_FOLDER / "lib").glob("python*/site-packages"))
    if not (packages and (packages[0] / "pyradiance").is_dir()):
        _need([str(_PYTHON), "-m", "pip", "install", "--quiet", f"pyradiance=={VERSION}"])
        packages = list((_FOLDER / "lib").glob("python*/site-packages"))
    package = packages[0] / "pyradiance"
    return package / "bin", package / "lib"


def prepare(document: Document, folder: Path) -> Radiance:
    """A document of quads, boxes, even lamps and an overcast sky, z up, in Radiance's language."""
    programs, library = install()
    scene, octree = folder / "scene.rad", folder / "scene.oct"
    scene.write_text("\n".join(_lines(document)))
    with octree.open("wb") as file:
        words = [str(programs / "oconv"), str(scene)]
        done = subprocess.run(
            words, stdout=file, stderr=subprocess.PIPE, env=_environment(library), check=False
        )
    if done.returncode != 0:
        raise Skipped(f"oconv: {done.stderr.decode(errors='replace')}")
    return Radiance(programs, library, octree)


def _lines(document: Document) -> list[str]:
    lines = []
    for index, surface in enumerate(document["surfaces"]):
        lamp = surface.get("luminaire")
        if lamp:
            radiance = lamp["radiance"]["luminance"] / _EFFICACY
            lines.append(f"void light m{index} 0 0 3 {radiance} {radiance} {radiance}")
        else:
            grey = surface["kernel"]["reflectance"]
            lines.append(f"void plastic m{index} 0 0 5 {grey} {grey} {grey} 0 0")
        for number, corners in enumerate(_polygons(surface["shape"])):
            numbers = " ".join(f"{value}" for corner in corners for value in corner)
            lines.append(f"m{index} polygon p{index}_{number} 0 0 12 {numbers}")
    if "environment" in document:
        zenith = document["environment"]["illuminance"] * 9.0 / (7.0 * pi) / _EFFICACY
        lines.append(f"void brightfunc sky 2 skybr skybright.cal 0 3 {_OVERCAST} {zenith} 0")
        lines.append("sky glow glows 0 0 4 1 1 1 0")
        lines.append("glows source above 0 0 4 0 0 1 180")
    return lines


def _polygons(shape: Document) -> list[list[Channel]]:
    if shape["type"] == "quad":
        corner, u, v = (np.array(shape[name], dtype=float) for name in ("corner", "edge_u", "edge_v"))
        return [[corner, corner + u, corner + u + v, corner + v]]
    low, high = (np.array(shape[name], dtype=float) for name in ("minimum", "maximum"))
    faces: list[list[Channel]] = []
    for axis in range(3):
        u, v = (np.eye(3)[other] * (high - low) for other in range(3) if other != axis)
        corners = (low, low + np.eye(3)[axis] * (high - low))
        faces.extend([at, at + u, at + u + v, at + v] for at in corners)
    return faces


def _environment(library: Path) -> dict[str, str]:
    return {**os.environ, "RAYPATH": f".:{library}"}


def _run(words: list[str], text: str, library: Path) -> str:
    done = subprocess.run(
        words, input=text, capture_output=True, text=True, env=_environment(library), check=False
    )
    if done.returncode != 0:
        raise Skipped(f"{words[0]}: {done.stderr.strip()}")
    return done.stdout


def _need(words: list[str]) -> None:
    done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        last = (done.stderr.strip() or done.stdout.strip()).rpartition("\n")[2]
        raise Skipped(f"Radiance can't be installed: {last}")
