"""Writes the documents of this studio next to itself, or into a folder, with their meshes and light.

The light of metals.json and bubbles.json is a map of two soft boxes before a dim room; lengths are metres.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import trimesh
from numpy.typing import NDArray

Part = dict[str, Any]
Profile = list[tuple[float, float]]
"""Radius and height of a turned body, from the bottom up."""

WIDTH, HEIGHT = 512, 256
"""Of the map, pixels."""

TURN = 128
"""Corners around a turned body."""

VASES: dict[str, Profile] = {
    "amphora": [
        (0, 0),
        (0.3, 0),
        (0.32, 0.04),
        (0.2, 0.12),
        (0.42, 0.5),
        (0.5, 0.9),
        (0.42, 1.25),
        (0.2, 1.5),
        (0.17, 1.7),
        (0.3, 1.85),
    ],
    "bowl": [(0, 0), (0.28, 0), (0.3, 0.03), (0.14, 0.1), (0.2, 0.2), (0.5, 0.42), (0.66, 0.75), (0.7, 0.85)],
    "bulb": [
        (0, 0),
        (0.24, 0),
        (0.4, 0.15),
        (0.52, 0.45),
        (0.46, 0.75),
        (0.2, 1.0),
        (0.1, 1.25),
        (0.09, 1.6),
        (0.16, 1.75),
    ],
    "drop": [
        (0, 0),
        (0.36, 0),
        (0.5, 0.2),
        (0.5, 0.45),
        (0.34, 0.85),
        (0.18, 1.25),
        (0.12, 1.5),
        (0.2, 1.62),
    ],
}

FLASKS: dict[str, Profile] = {
    "round": [
        (0, 0),
        (0.25, 0.01),
        (0.44, 0.14),
        (0.52, 0.4),
        (0.46, 0.66),
        (0.28, 0.86),
        (0.13, 1.02),
        (0.12, 1.5),
        (0.15, 1.56),
    ],
    "cone": [
        (0, 0),
        (0.44, 0.0),
        (0.49, 0.06),
        (0.42, 0.3),
        (0.28, 0.7),
        (0.15, 1.02),
        (0.13, 1.3),
        (0.16, 1.38),
    ],
    "tall": [
        (0, 0),
        (0.24, 0.0),
        (0.28, 0.04),
        (0.28, 1.2),
        (0.24, 1.36),
        (0.12, 1.5),
        (0.11, 1.8),
        (0.14, 1.86),
    ],
}


def main(folder: Path) -> None:
    """Write documents, meshes and the map into `folder`."""
    for name, profile in VASES.items():
        turned(profile).export(folder / f"{name}.ply")
    for name, profile in FLASKS.items():
        outside = smooth(profile)
        turned_points(outside).export(folder / f"{name}_glass.ply")
        turned_points(filling(outside, 0.62 * outside[-1, 1])).export(folder / f"{name}_liquid.ply")
    write_map(folder / "studio.exr")
    for name, document in (
        ("metals", metals()),
        ("anodised", anodised()),
        ("bubbles", bubbles()),
        ("liquids", liquids()),
    ):
        (folder / f"{name}.json").write_text(json.dumps(document, indent=1) + "\n")


def smooth(profile: Profile) -> NDArray[np.float64]:
    """A Catmull-Rom curve through the points of a profile, eight pieces each."""
    points = np.array(profile)
    ends = np.concatenate([points[:1], points, points[-1:]])
    t = np.linspace(0, 1, 9)[:-1, None]
    pieces = []
    for a, b, c, d in zip(ends, ends[1:], ends[2:], ends[3:], strict=False):
        pieces.append(
            0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
        )
    curve = np.concatenate([*pieces, points[-1:]])
    curve[:, 0] = np.maximum(curve[:, 0], 0.0)
    return curve


def turned(profile: Profile) -> trimesh.Trimesh:
    """A closed vase: the inside is 0.02 from the outside."""
    outside = smooth(profile)
    inside = outside[np.argmax(outside[:, 1] > 0.1) :].copy()
    inside[:, 0] = np.maximum(inside[:, 0] - 0.02, 0.01)
    inside[0] = (0.0, inside[0, 1])
    return turned_points(np.concatenate([outside, inside[::-1]]))


def filling(outside: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    """What fills a flask up to a level, reaching half of the wall's 0.02 into the glass."""
    inside = outside[(outside[:, 1] > 0.012) & (outside[:, 1] < level)].copy()
    inside[:, 0] = np.maximum(inside[:, 0] - 0.02, 0.005)
    top = inside[-1]
    return np.concatenate([[[0.0, inside[0, 1]]], inside, [[0.0, top[1]]]])


def turned_points(curve: NDArray[np.float64]) -> trimesh.Trimesh:
    """The curve's points turned about y; normals point outwards."""
    angle = 2 * np.pi * np.arange(TURN) / TURN
    x, z = curve[:, :1] * np.cos(angle), curve[:, :1] * np.sin(angle)
    y = np.repeat(curve[:, 1:], TURN, axis=1)
    points = np.round(np.stack([x, y, z], axis=-1).reshape(-1, 3), 6)
    low = np.arange(len(curve) - 1)[:, None] * TURN + np.arange(TURN)
    right = np.arange(len(curve) - 1)[:, None] * TURN + (np.arange(TURN) + 1) % TURN
    faces = np.concatenate(
        [np.stack([low, low + TURN, right], axis=-1), np.stack([right, low + TURN, right + TURN], axis=-1)]
    ).reshape(-1, 3)
    mesh = trimesh.Trimesh(points, faces, process=True)
    mesh.update_faces(mesh.nondegenerate_faces())
    return mesh


def write_map(file: Path) -> None:
    """Two soft boxes, one warm and one cool, and a ring of dim light at the horizon."""
    down = np.pi * (np.arange(HEIGHT) + 0.5)[:, None] / HEIGHT
    around = 2 * np.pi * (np.arange(WIDTH) + 0.5)[None, :] / WIDTH - np.pi
    room = 0.05 + 0.3 * np.exp(-(((down - 1.5) / 0.35) ** 2)) + 0.1 * np.sin(0.5 * down) * (down < 1.6)
    image = room[..., None] * np.array([0.5, 0.7, 1.1])
    for place, height, size, tall, colour in (
        (-1.9, 1.0, 0.55, 0.45, (5.0, 4.3, 3.4)),
        (1.7, 0.9, 0.35, 0.6, (3.0, 3.6, 4.6)),
        (0.1, 0.35, 1.6, 0.2, (1.6, 1.6, 1.6)),
    ):
        box = _edge(size - np.abs(around - place)) * _edge(tall - np.abs(down - height))
        image = image + box[..., None] * np.array(colour)
    picture = oiio.ImageBuf(oiio.ImageSpec(WIDTH, HEIGHT, 3, oiio.FLOAT))
    picture.set_pixels(oiio.ROI(), image.astype(np.float32))
    if not picture.write(str(file)):
        raise OSError(picture.geterror())


def _edge(inside: NDArray[np.float64]) -> NDArray[np.float64]:
    """0 to 1 over 0.12 radians."""
    t = np.clip(inside / 0.12 + 0.5, 0, 1)
    return t * t * (3 - 2 * t)


def metals() -> Part:
    """Vases of five metals on a dark mirror."""
    metals = ("Au", "Cu", "Ag", "Cr", "Cu", "Al")
    return _vases("Metals", [{"type": "conductor", "index": metal} for metal in metals])


def anodised() -> Part:
    """The same vases of chromium under layers of other thickness."""
    layers = ([{"index": 2.35, "thickness_nm": thick}] for thick in (38, 62, 95, 130, 165, 205))
    return _vases("Interference", [{"type": "conductor", "index": "Cr", "coating": each} for each in layers])


def _vases(name: str, kernels: list[Part]) -> Part:
    """Roulette starts late: polished metal scatters light nowhere else."""
    places = [
        ("amphora", -1.75, 0.0),
        ("bowl", -0.62, 0.75),
        ("bulb", -0.2, -0.75),
        ("drop", 0.8, 0.25),
        ("amphora", 1.75, -0.5),
        ("bowl", 1.9, 0.85),
    ]
    surfaces: list[Part] = [_floor({"type": "conductor", "index": {"n": 2.2, "k": 0.6}})]
    for (shape, x, z), kernel in zip(places, kernels, strict=True):
        mesh = {"type": "mesh", "asset": f"{shape}.ply", "smooth": True}
        surfaces.append({"name": shape, "shape": mesh, "kernel": kernel, "translate": [x, 0, z]})
    document = _document(
        name, "Light of two soft boxes in a dim room.", [0, 1.55, 6.6], [0.06, 0.72, 0], 24, surfaces
    )
    document["tracing"] = {"h": 100}
    return document


def bubbles() -> Part:
    """Soap bubbles, each of another thickness."""
    random = np.random.default_rng(4)
    surfaces: list[Part] = []
    placed: list[tuple[NDArray[np.float64], float]] = []
    while len(placed) < 26:
        radius = float(random.uniform(0.16, 0.62)) * (1 if len(placed) > 4 else 1.25)
        centre = random.uniform([-3.3, -1.55, -2.0], [3.3, 1.55, 0.8])
        if all(np.linalg.norm(centre - other) > radius + size + 0.03 for other, size in placed):
            placed.append((centre, radius))
            film = {"index": 1.33, "thickness_nm": round(float(random.uniform(140, 700)))}
            surfaces.append(
                {
                    "shape": {
                        "type": "sphere",
                        "centre": [round(float(each), 3) for each in centre],
                        "radius": round(radius, 3),
                    },
                    "kernel": {"type": "glazing", "panes": [{"film": [film]}]},
                }
            )
    return _document("Soap bubbles", "Films of 140 to 700 nm.", [0, 0, 7.5], [0, 0, 0], 25, surfaces)


def liquids() -> Part:
    """Coloured water in flasks before a bright wall."""
    dyes = {
        "red": [[380, 6], [480, 9], [560, 8], [600, 0.8], [640, 0.1], [780, 0.05]],
        "amber": [[380, 14], [450, 8], [520, 1.6], [580, 0.4], [650, 0.1], [780, 0.05]],
        "green": [[380, 7], [450, 4], [520, 0.3], [560, 0.6], [620, 5], [680, 6], [780, 3]],
        "blue": [[380, 1], [450, 0.2], [500, 1.2], [560, 5], [620, 8], [680, 5], [780, 1]],
        "violet": [[380, 0.6], [440, 0.7], [500, 4], [560, 7], [600, 3], [650, 0.5], [780, 0.2]],
    }
    rows = [
        ("round", "red", -2.1, 0.1),
        ("tall", "amber", -1.05, -0.35),
        ("cone", "green", 0.0, 0.25),
        ("tall", "blue", 1.0, -0.3),
        ("round", "violet", 2.05, 0.1),
    ]
    surfaces: list[Part] = [_floor({"type": "coated_diffuse", "index": 1.5, "reflectance": 0.6})]
    for shape, dye, x, z in rows:
        surfaces.extend(
            {
                "name": f"{shape}, {part}",
                "shape": {"type": "mesh", "asset": f"{shape}_{part}.ply", "smooth": True},
                "kernel": part if part == "glass" else f"{dye} water",
                "translate": [x, 0.002, z],
            }
            for part in ("glass", "liquid")
        )
    kernels: Part = {"glass": {"type": "dielectric", "index": 1.47}}
    for dye, table in dyes.items():
        kernels[f"{dye} water"] = {
            "type": "dielectric",
            "index": 1.333,
            "priority": 1,
            "absorption": {"table": table},
        }
    document = _document(
        "Coloured water", "Before even light of D65.", [0, 1.25, 6.9], [0, 0.78, 0], 22, surfaces
    )
    document["kernels"] = kernels
    document["environment"] = {"radiance": {"illuminant": "D65", "luminance": 1000}}
    return document


def _floor(kernel: Part) -> Part:
    quad = {"type": "quad", "corner": [-30, 0, -30], "edge_u": [0, 0, 60], "edge_v": [60, 0, 0]}
    return {"name": "floor", "shape": quad, "kernel": kernel}


def _document(
    name: str, note: str, position: list[float], look_at: list[float], field: float, surfaces: list[Part]
) -> Part:
    return {
        "nocturne": 1,
        "name": name,
        "source": "Made up for this project. make_studio.py writes it.",
        "note": note,
        "environment": {"asset": "studio.exr", "luminance": 1000},
        "sensor": {
            "type": "pinhole",
            "position": position,
            "look_at": look_at,
            "vertical_field_of_view_degrees": field,
        },
        "surfaces": surfaces,
    }


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
