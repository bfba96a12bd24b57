"""Simulates the smoke of this scene and writes it as smoke.vdb: hot gas that rises from a small source.

Incompressible flow on a grid, after J. Stam, "Stable Fluids", SIGGRAPH 1999, with buoyancy and vorticity
confinement after R. Fedkiw, J. Stam and H. W. Jensen, "Visual Simulation of Smoke", SIGGRAPH 2001. The box is
periodic, so that the pressure is solved by Fourier transforms.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from nocturne_scene.programs import find_program
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

Field = NDArray[np.float32]

CELLS = (64, 112, 64)
"""x, y (up), z."""
CELL = 0.025
"""Metres."""
STEPS, STEP = 110, 0.04
"""Of time; seconds."""
SOURCE, SOURCE_RADIUS = (0.8, 0.2, 0.8), 0.14
"""Metres."""
HOT, AMBIENT = 900.0, 293.0
"""Kelvin."""
BUOYANCY, CONFINEMENT, COOLING = 0.012, 0.35, 0.35
"""m/s2 per K; of vorticity; 1/s."""


def main(folder: Path) -> None:
    """Write smoke.vdb into `folder`."""
    density, temperature = simulate()
    with tempfile.TemporaryDirectory() as made:
        grids = {"density": density, "temperature": temperature}
        for name, values in grids.items():
            values.astype("<f4").tofile(Path(made) / f"{name}.f32")
        description = {
            "dims": CELLS,
            "voxel_size": CELL,
            "origin": [-0.8, 0.0, -0.8],
            "grids": [
                {"name": "density", "file": "density.f32", "tolerance": 1e-3, "half": True},
                {"name": "temperature", "file": "temperature.f32", "tolerance": 1.0, "background": AMBIENT},
            ],
        }
        plan = Path(made) / "smoke.json"
        plan.write_text(json.dumps(description))
        program = find_program("nocturne-grid")
        if program is None:
            sys.exit("nocturne-grid is missing; build it with `make build`")
        subprocess.run([program, "create", plan, "-o", folder / "smoke.vdb"], check=True)  # noqa: S603


def simulate() -> tuple[Field, Field]:
    """Density (1 at the source) and temperature (K) after all steps, indexed by x, y, z."""
    places = np.stack(np.meshgrid(*(np.arange(n, dtype=np.float32) for n in CELLS), indexing="ij"))
    middle = (places + 0.5) * CELL - np.array(SOURCE, dtype=np.float32)[:, None, None, None]
    source = np.sqrt((middle**2).sum(axis=0)) < SOURCE_RADIUS
    # What makes the column break up; fixed, so that the file is always the same.
    stir = 0.3 * np.random.default_rng(4).standard_normal((3, *CELLS)).astype(np.float32)
    velocity = np.zeros((3, *CELLS), dtype=np.float32)
    density = np.zeros(CELLS, dtype=np.float32)
    heat = np.zeros(CELLS, dtype=np.float32)
    for _ in range(STEPS):
        density[source] = 1.0
        heat[source] = HOT - AMBIENT
        velocity[1] += STEP * BUOYANCY * heat
        velocity += STEP * (_confinement(velocity) + stir * source)
        velocity = _without_divergence(velocity)
        back = places - STEP / CELL * velocity
        velocity = np.stack([_moved(each, back) for each in velocity])
        density = _moved(density, back)
        heat = _moved(heat, back) * np.float32(np.exp(-STEP * COOLING))
        # What would come in again from below has left.
        for field in (density, heat):
            field[:, -6:] = 0.0
    return np.maximum(density, np.float32(0)), np.float32(AMBIENT) + np.maximum(heat, np.float32(0))


def _moved(field: Field, places: Field) -> Field:
    return np.asarray(map_coordinates(field, places, order=1, mode="grid-wrap"), dtype=np.float32)


def _gradient(field: Field) -> Field:
    return np.stack([(np.roll(field, -1, axis) - np.roll(field, 1, axis)) / (2 * CELL) for axis in range(3)])


def _confinement(velocity: Field) -> Field:
    """The force that keeps small swirls, m/s2."""
    u, v, w = (_gradient(each) for each in velocity)
    curl = np.stack([w[1] - v[2], u[2] - w[0], v[0] - u[1]])
    slope = _gradient(np.sqrt((curl**2).sum(axis=0)))
    slope /= np.sqrt((slope**2).sum(axis=0)) + 1e-6
    return np.asarray(CONFINEMENT * CELL * np.cross(slope, curl, axis=0), dtype=np.float32)


def _without_divergence(velocity: Field) -> Field:
    """Each wave keeps the component across its direction."""
    waves = np.stack(np.meshgrid(*(np.fft.fftfreq(n) for n in CELLS), indexing="ij"))
    square = (waves**2).sum(axis=0)
    square[0, 0, 0] = 1.0
    spectrum = np.fft.fftn(velocity, axes=(1, 2, 3))
    spectrum -= waves * ((waves * spectrum).sum(axis=0) / square)
    return np.asarray(np.fft.ifftn(spectrum, axes=(1, 2, 3)).real, dtype=np.float32)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
