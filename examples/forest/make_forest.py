"""Writes this scene: a valley of spruces around a hut whose chimney smokes, under the sky of clean air.

A branch is a mesh. A tree is a trunk and some sixty instances of the branch; the forest is instances of three
trees. The smoke is that of the scene `smoke`, larger. Seeds of random numbers are fixed.
"""

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Points = NDArray[np.float64]
Document = dict[str, Any]

TREES = 3000
EDGE = 520.0
"""Of the ground, m."""
HUT = (6.0, -62.0)
CAMERA = (-14.0, 38.0)
"""Along x and z, m."""
CLEARING = 17.0
"""Radius around the hut without trees, m."""
TREE = 10.0
"""Height of a tree before it is scaled, m."""
SPECTRA: Document = {
    "needles": {
        "table": [
            [400, 0.03],
            [500, 0.045],
            [550, 0.11],
            [600, 0.06],
            [680, 0.035],
            [720, 0.2],
            [760, 0.4],
        ]
    },
    "grass": {
        "table": [
            [400, 0.04],
            [500, 0.07],
            [550, 0.15],
            [600, 0.13],
            [680, 0.09],
            [720, 0.28],
            [760, 0.42],
        ]
    },
    "bark": {"table": [[400, 0.05], [550, 0.11], [700, 0.2]]},
    "planks": {"table": [[400, 0.09], [500, 0.16], [600, 0.28], [700, 0.38]]},
    "shingles": {"table": [[400, 0.1], [550, 0.13], [620, 0.22], [700, 0.27]]},
}
KERNELS: Document = {
    "needles": {"type": "diffuse_transmitter", "reflectance": "needles", "transmittance": "needles"},
    "grass": {"type": "lambertian", "reflectance": "grass"},
    "bark": {"type": "lambertian", "reflectance": "bark"},
    "planks": {"type": "lambertian", "reflectance": "planks"},
    "shingles": {"type": "lambertian", "reflectance": "shingles"},
}


def main(folder: Path) -> None:
    """Write scene.json and its files into `folder`."""
    made = write_meshes(folder)
    places = tree_places()
    (folder / "scene.json").write_text(json.dumps(scene(places), indent=1) + "\n")
    smoke_maker().main(folder)
    twigs = sum(len(tree(kind)) - 1 for kind in range(3)) / 3
    triangles = len(places) * (twigs * len(made["branch"].faces) + len(made["trunk"].faces))
    print(f"{len(places)} trees, {triangles / 1e6:.0f} million triangles")


def write_meshes(folder: Path) -> dict[str, trimesh.Trimesh]:
    """Write PLY files; return them by name."""
    made = {"branch": branch(), "trunk": trunk(), "ground": ground(), "hut": walls(), "roof": roof()}
    for name, mesh in made.items():
        mesh.vertices = np.round(mesh.vertices, 5)
        mesh.export(folder / f"{name}.ply")
    return made


def smoke_maker() -> ModuleType:
    """The simulation of the scene `smoke`."""
    place = Path(__file__).parents[1] / "smoke" / "make_smoke.py"
    spec = importlib.util.spec_from_file_location("make_smoke", place)
    if spec is None or spec.loader is None:
        sys.exit(f"{place} is missing")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def height(x: Points, z: Points) -> Points:
    """Of the ground, m: a valley that rises to the back and to the sides; flat around the hut."""
    far = np.maximum(0.0, -z - 90.0)
    hills = 6e-4 * far**2 + 2.5e-4 * x**2 + 6.0 * np.exp(-(((z - 45.0) / 25.0) ** 2))
    waves = 2.5 * np.sin(0.031 * x + 1.0) * np.sin(0.027 * z) + 0.8 * np.sin(0.11 * x) * np.cos(
        0.09 * z + 0.5
    )
    flat = np.exp(-(((x - HUT[0]) ** 2 + (z - HUT[1]) ** 2) / 25.0**2))
    return np.asarray(5.0 + hills * (1 - flat) + waves * (1 - flat))


def at(x: float, z: float) -> float:
    """The height of a point."""
    return float(height(np.array(x), np.array(z)))


def ground() -> trimesh.Trimesh:
    """A net of 260 x 260 squares."""
    count = 261
    x, z = np.meshgrid(
        np.linspace(-EDGE / 2, EDGE / 2, count), np.linspace(-EDGE + 90, 90, count), indexing="ij"
    )
    points = np.stack([x, height(x, z), z], axis=-1).reshape(-1, 3)
    corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + count], axis=1),
            np.stack([corner + 1, corner + count + 1, corner + count], axis=1),
        ]
    )
    return trimesh.Trimesh(points, faces, process=False)


def branch() -> trimesh.Trimesh:
    """A spray of needles, 1 long along x, that hangs a little; y is up."""
    random = np.random.default_rng(1)
    sheets = []
    for step in range(26):
        t = (step + 1.5) / 28
        reach = 0.42 * (1.0 - t) ** 0.7 + 0.05
        for side in (-1.0, 1.0):
            turn = side * random.uniform(0.7, 1.0)
            along = np.array([np.cos(turn), random.uniform(-0.25, 0.05), np.sin(turn)])
            start = np.array([t, -0.25 * t * t, 0.0])
            sheets.append(_needles(start, along / np.linalg.norm(along), reach, random))
    sheets.append(_needles(np.zeros(3), np.array([0.97, -0.24, 0.0]), 1.0, random, count=30))
    points = np.concatenate(sheets)
    return trimesh.Trimesh(points, np.arange(len(points)).reshape(-1, 3), process=False)


def _needles(
    start: Points, along: Points, reach: float, random: np.random.Generator, count: int = 14
) -> Points:
    """Triangles on both sides of a twig, which is a thin one itself; shape (corners, 3)."""
    across = np.cross(along, [0.0, 1.0, 0.0])
    triangles = [start, start + reach * along, start + 0.012 * across]
    for each in range(count):
        at_twig = start + reach * (each + 1) / count * along
        for side in (-1.0, 1.0):
            tip = 0.055 * (0.6 * along + side * across + np.array([0.0, random.uniform(-0.3, 0.6), 0.0]))
            width = 0.008 * along + 0.006 * random.standard_normal(3)
            triangles += [at_twig - width, at_twig + width, at_twig + tip]
    return np.array(triangles)


def trunk() -> trimesh.Trimesh:
    """A cone."""
    count = 12
    angles = 2.0 * np.pi * np.arange(count) / count
    rim = 0.16 * np.stack([np.cos(angles), np.zeros(count), np.sin(angles)], axis=1)
    here = np.arange(count)
    faces = np.stack([here, np.full(count, count), (here + 1) % count], axis=1)
    return trimesh.Trimesh(np.concatenate([rim, [[0.0, TREE, 0.0]]]), faces, process=False)


def walls() -> trimesh.Trimesh:
    """Of the hut, with its chimney."""
    parts = []
    for size, middle in (((6.0, 3.0, 4.5), (0.0, 1.5, 0.0)), ((0.7, 2.2, 0.7), (1.6, 5.0, 0.0))):
        part = trimesh.creation.box(size)
        part.vertices = part.vertices + np.array(middle)
        parts.append(part)
    corners = len(parts[0].vertices)
    return trimesh.Trimesh(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([parts[0].faces, parts[1].faces + corners]),
        process=False,
    )


def roof() -> trimesh.Trimesh:
    """A prism along x."""
    section = np.array([[0.0, 2.9, -2.9], [0.0, 2.9, 2.9], [0.0, 5.2, 0.0]])
    gable = np.array([3.5, 0.0, 0.0])
    points = np.concatenate([section - gable, section + gable])
    faces = [[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]]
    return trimesh.Trimesh(points, faces, process=False)


def tree(kind: int) -> list[Document]:
    """A trunk, and branches around it that are shorter towards the top."""
    random = np.random.default_rng(10 + kind)
    members: list[Document] = [
        {"shape": {"type": "mesh", "asset": "trunk.ply"}, "kernel": "bark"},
    ]
    low = random.uniform(0.6, 1.4)
    for y in np.arange(low, TREE - 0.15, 0.75):
        part = (TREE - y) / TREE
        turn = random.uniform(0.0, 2.0 * np.pi)
        for each in range(5 if part > 0.3 else 4):
            azimuth = turn + 2.0 * np.pi * each / 5 + random.uniform(-0.25, 0.25)
            pitch = np.radians(random.uniform(-12.0, 2.0) + 35.0 * (1.0 - part) ** 2)
            size = (2.9 * part**0.8 + 0.25) * random.uniform(0.85, 1.1)
            members.append(
                {
                    "group": "branch",
                    "scale": round(float(size), 4),
                    "rotate": _turn(azimuth, pitch),
                    "translate": [0.0, round(float(y), 4), 0.0],
                }
            )
    return members


def _turn(azimuth: float, pitch: float) -> Document:
    """First up about z, then about y, as one rotation."""
    vector = Rotation.from_euler("zy", [pitch, azimuth]).as_rotvec(degrees=True)
    return {"axis": np.round(vector, 6).tolist(), "degrees": round(float(np.linalg.norm(vector)), 4)}


def tree_places(count: int = TREES) -> list[Document]:
    """Trees in random places, but not near the hut or the camera, nor between them."""
    random = np.random.default_rng(2)
    places: list[Document] = []
    while len(places) < count:
        x, z = random.uniform(-240.0, 240.0), random.uniform(-400.0, 60.0)
        size = random.uniform(0.55, 1.5)
        if _is_free(x, z):
            places.append(
                {
                    "group": f"spruce {random.integers(3)}",
                    "scale": round(float(size), 3),
                    "rotate": {"axis": [0, 1, 0], "degrees": round(random.uniform(0.0, 360.0), 2)},
                    "translate": [round(x, 3), round(at(x, z) - 0.1, 3), round(z, 3)],
                }
            )
    return places


def _is_free(x: float, z: float) -> bool:
    if np.hypot(x - HUT[0], z - HUT[1]) < CLEARING:
        return False
    # Beside the line from the camera to the hut, wider towards the hut.
    from_camera = CAMERA[1] - z
    length = CAMERA[1] - HUT[1]
    line = CAMERA[0] + (HUT[0] - CAMERA[0]) * from_camera / length
    return not (-25.0 < from_camera < length and abs(x - line) < 5.0 + 0.09 * max(from_camera, 0.0))


def smoke_place(ground_height: float, size: float) -> list[float]:
    """Where the smoke's file is put: its source, 0.2 above the file's origin, is at the chimney."""
    chimney = [
        HUT[0] + 1.6 * np.cos(np.radians(20)),
        ground_height + 6.1,
        HUT[1] - 1.6 * np.sin(np.radians(20)),
    ]
    return [round(float(v), 3) for v in np.array(chimney) - [0.0, 0.2 * size, 0.0]]


def scene(places: list[Document]) -> Document:
    """The document."""
    ground_height = at(*HUT)
    hut = {"translate": [HUT[0], ground_height, HUT[1]], "rotate": {"axis": [0, 1, 0], "degrees": 20}}
    size = 14.0
    eye = [CAMERA[0], at(*CAMERA) + 3.2, CAMERA[1]]
    return {
        "nocturne": 1,
        "name": "Forest",
        "source": "Made up by make_forest.py; air after Bodhaine et al. 1999, the Sun after ASTM G173-03.",
        "note": "Instances of instances, smoke of a simulation, the sky and the Sun: figure 1 of the paper.",
        "spectra": SPECTRA,
        "kernels": KERNELS,
        "media": {
            "smoke": {
                "absorption": 0.02,
                "scattering": 0.45,
                "phase": {"type": "henyey_greenstein", "g": 0.4},
                "density": {
                    "asset": "smoke.vdb",
                    "grid": "density",
                    "scale": size,
                    "translate": smoke_place(ground_height, size),
                },
            }
        },
        "atmosphere": {"ozone": {}, "ground_reflectance": 0.1},
        "distant": [{"direction": [-0.8, 0.38, -0.4], "sun": True, "limb_darkening": True}],
        "sensor": {
            "type": "pinhole",
            "position": [round(float(v), 3) for v in eye],
            "look_at": [HUT[0] - 1.0, round(ground_height + 10.5, 3), HUT[1]],
            "vertical_field_of_view_degrees": 30,
        },
        "groups": {
            "branch": [{"shape": {"type": "mesh", "asset": "branch.ply"}, "kernel": "needles"}],
            **{f"spruce {kind}": tree(kind) for kind in range(3)},
        },
        "surfaces": [
            {
                "name": "ground",
                "shape": {"type": "mesh", "asset": "ground.ply", "smooth": True},
                "kernel": "grass",
            },
            {"name": "hut", "shape": {"type": "mesh", "asset": "hut.ply"}, "kernel": "planks", **hut},
            {"name": "roof", "shape": {"type": "mesh", "asset": "roof.ply"}, "kernel": "shingles", **hut},
            {
                "name": "smoke",
                "shape": {"type": "medium_box", "medium": "smoke"},
                "interior": {"media": ["smoke"]},
            },
        ],
        "instances": places,
    }


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
