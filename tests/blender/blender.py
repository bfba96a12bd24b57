"""Blender's Python module in a separate environment, made by `make blender`."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenEXR

TOP = Path(__file__).parents[2]
PYTHON = TOP / "build" / "blender" / "bin" / "python"
_PROGRAM = Path(__file__).with_name("in_blender.py")
# A guard alone.
_LONGEST_S = 300


@dataclass(frozen=True)
class Rendered:
    """What Blender had at the end."""

    rgb: npt.NDArray[np.float32]
    """Linear, of the combined image; shape (height, width, 3), top row first."""
    passes: dict[str, npt.NDArray[np.float32]]
    """The others, of our engine: shape (height, width, channels)."""
    said: str


def run(script: Path, *words: str) -> str:
    """Runs a program in Blender's Python; returns its output."""
    command = [str(PYTHON), str(script), *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=_LONGEST_S, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def render(folder: Path, scene: str, engine: str, *words: str) -> Rendered:
    """Renders one of `scenes.py`."""
    output = folder / f"{scene}-{engine}.exr"
    said = run(_PROGRAM, scene, engine, str(output), *words)
    passes: dict[str, npt.NDArray[np.float32]] = {}
    for part in OpenEXR.File(str(output)).parts:
        for name, channel in part.channels.items():
            _, which, *letters = name.split(".")
            # The library puts R, G, B, A together, and leaves other channels alone.
            pixels = channel.pixels if channel.pixels.ndim == 3 else channel.pixels[..., None]
            passes[which] = np.concatenate([passes[which], pixels], axis=2) if which in passes else pixels
            assert len(letters) <= 1
    return Rendered(passes.pop("Combined")[..., :3], passes, said)
