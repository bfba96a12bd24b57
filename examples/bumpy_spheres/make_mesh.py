"""Writes the meshes of this scene next to itself, or into a folder given as argument.

64 bumpy spheres in four colours. Each is a grid of latitudes and longitudes whose radius varies with three
waves, different for each sphere. Positions are rounded to a micrometre, so that the last bits of a machine's
sine make no difference.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

COLOURS = ("brick", "moss", "cobalt", "ochre")
PER_SIDE = 8
SPACING = 0.26  # m
RADIUS = 0.1  # m
HEIGHT = 0.16  # m, of the centres
BANDS = 64  # of latitude, pole to pole
SECTORS = 125  # of longitude
TRIANGLES_PER_SPHERE = 2 * SECTORS * (BANDS - 1)


def sphere_indices() -> NDArray[np.int32]:
    """Return the triangles of one sphere, shape (TRIANGLES_PER_SPHERE, 3).

    North pole is vertex 0, south pole the last.
    """
    rows = BANDS - 1
    sector = np.arange(SECTORS)
    following = (sector + 1) % SECTORS
    south = 1 + rows * SECTORS
    last = 1 + (rows - 1) * SECTORS
    caps = [
        np.stack([np.zeros_like(sector), 1 + following, 1 + sector], axis=1),
        np.stack([np.full_like(sector, south), last + sector, last + following], axis=1),
    ]
    upper = (1 + SECTORS * np.arange(rows - 1))[:, None]
    a, b = upper + sector, upper + following
    c, d = a + SECTORS, b + SECTORS
    bands = [np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((a, b, c), (b, d, c))]
    return np.concatenate([*caps, *bands]).astype(np.int32)


def sphere_vertices(number: int) -> NDArray[np.float64]:
    """Return the vertices of a bumpy sphere about the origin, shape (n, 3), metres."""
    latitude = np.pi * np.arange(1, BANDS) / BANDS
    longitude = 2 * np.pi * np.arange(SECTORS) / SECTORS
    theta, phi = (grid.ravel() for grid in np.meshgrid(latitude, longitude, indexing="ij"))
    directions = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=1)
    directions = np.concatenate([[[0.0, 1.0, 0.0]], directions, [[0.0, -1.0, 0.0]]])
    random = np.random.default_rng(number)
    waves = random.normal(0.0, 14.0, (3, 3))
    phases = random.uniform(0.0, 2 * np.pi, 3)
    bumps = np.sin(directions @ waves.T + phases).sum(axis=1)
    return np.asarray(RADIUS * (1 + 0.04 * bumps)[:, None] * directions, dtype=np.float64)


def centre(number: int) -> NDArray[np.float64]:
    """Return where a sphere stands: on a square grid around the origin."""
    row, column = divmod(number, PER_SIDE)
    middle = (PER_SIDE - 1) / 2
    return np.array([(column - middle) * SPACING, HEIGHT, (row - middle) * SPACING])


def colour(number: int) -> str:
    """Return the colour of a sphere; each colour has sixteen, spread over the grid."""
    row, column = divmod(number, PER_SIDE)
    return COLOURS[(column + 2 * row + row // 2) % len(COLOURS)]


def write_ply(path: Path, vertices: NDArray[np.float64], indices: NDArray[np.int32]) -> None:
    """Write a mesh as binary PLY."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(indices)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(indices), dtype=[("count", "u1"), ("indices", "<i4", 3)])
    faces["count"] = 3
    faces["indices"] = indices
    path.write_bytes(header.encode("ascii") + np.round(vertices, 6).astype("<f4").tobytes() + faces.tobytes())


def main(folder: Path) -> None:
    """Write one file for each colour."""
    one = sphere_indices()
    for name in COLOURS:
        numbers = [number for number in range(PER_SIDE**2) if colour(number) == name]
        parts = [sphere_vertices(number) + centre(number) for number in numbers]
        indices = [one + np.int32(index * len(part)) for index, part in enumerate(parts)]
        write_ply(folder / f"{name}.ply", np.concatenate(parts), np.concatenate(indices))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
