"""Writes this room's documents, photometric file and evening sky next to itself, or into a folder.

5.6 m by 7.4 m, 2.8 m high; x to the right, y up, z towards the camera. The window is at the far end.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation

LUMINAIRE = Path(__file__).parents[1] / "office" / "office.ies"
WIDTH, HEIGHT, DEPTH = 5.6, 2.8, 7.4  # m
TABLE = (1.9, 3.7, 1.5, 5.3, 0.74)
"""Left, right, far, near and height, m."""
Part = dict[str, Any]


def main(folder: Path) -> None:
    """Write room.ies, dusk.exr, view.json and table.json into `folder`."""
    (folder / "room.ies").write_bytes(LUMINAIRE.read_bytes())
    _write_sky(folder / "dusk.exr")
    view = {
        "type": "pinhole",
        "position": [1.0, 1.62, 7.2],
        "look_at": [3.05, 1.08, 2.2],
        "vertical_field_of_view_degrees": 50,
    }
    left, right, far, near, top = TABLE
    grid = {"corner": [left, top + 0.01, near], "right": [right - left, 0, 0], "up": [0, 0, far - near]}
    meters = {
        "type": "meters",
        "instruments": [{"name": "table", "grid": grid | {"columns": 12, "rows": 24}}],
    }
    for name, sensor in (("view", view), ("table", meters)):
        (folder / f"{name}.json").write_text(json.dumps(room(sensor), indent=1) + "\n")


def room(sensor: Part) -> Part:
    """The document for a sensor."""
    greys = {
        "ceiling": 0.8,
        "carpet": 0.18,
        "frame": 0.25,
        "screen": 0.05,
        "chair": 0.12,
        "metal": 0.4,
        "ground": 0.1,
        "house": 0.15,
    }
    kernels: Part = {name: {"type": "lambertian", "reflectance": value} for name, value in greys.items()}
    kernels["wall"] = {"type": "lambertian", "reflectance": {"rgb": [0.66, 0.64, 0.6]}}
    kernels["wood"] = {"type": "lambertian", "reflectance": {"rgb": [0.42, 0.27, 0.16]}}
    kernels["panel"] = {"type": "lambertian", "reflectance": {"rgb": [0.12, 0.25, 0.3]}}
    kernels["glass"] = {"type": "thin_pane", "index": 1.52, "transmittance": 0.97}
    return {
        "nocturne": 1,
        "name": "Meeting room at dusk",
        "source": "Made up for this project. make_room.py writes it.",
        "environment": {"asset": "dusk.exr", "luminance": 30},
        "kernels": kernels,
        "sensor": sensor,
        "surfaces": [*_luminaire(), *_shell(), *_furniture(), *_town()],
    }


def _luminaire() -> list[Part]:
    """A pendant of 2.4 m above the table, with the light of the file and of 7,000 lm."""
    left, right, far, near, _ = TABLE
    x, z, y = 0.5 * (left + right), 0.5 * (far + near), 2.05
    quad = {"type": "quad", "corner": [x - 0.09, y, z - 1.2], "edge_u": [0.18, 0, 0], "edge_v": [0, 0, 2.4]}
    light = {
        "radiance": {"blackbody": 3500},
        "profile": {"asset": "room.ies", "lumens": 7000},
        "maintenance_factor": 0.8,
    }
    return [
        {"name": "pendant", "shape": quad, "kernel": "ceiling", "luminaire": light},
        _box("housing", [x - 0.1, y + 0.002, z - 1.22], [x + 0.1, y + 0.05, z + 1.22], "metal"),
        *(
            _box("wire", [x - 0.006, y, z + w - 0.006], [x + 0.006, HEIGHT, z + w + 0.006], "metal")
            for w in (-1, 1)
        ),
    ]


def _shell() -> list[Part]:
    parts = [
        _quad("floor", [0, 0, 0], [0, 0, DEPTH], [WIDTH, 0, 0], "carpet"),
        _quad("ceiling", [0, HEIGHT, 0], [WIDTH, 0, 0], [0, 0, DEPTH], "ceiling"),
        _quad("wall, left", [0, 0, 0], [0, HEIGHT, 0], [0, 0, DEPTH], "wall"),
        _quad("wall, right", [WIDTH, 0, 0], [0, 0, DEPTH], [0, HEIGHT, 0], "wall"),
        _quad("wall, near", [0, 0, DEPTH], [0, HEIGHT, 0], [WIDTH, 0, 0], "wall"),
        _box("sill", [0, 0, -0.2], [WIDTH, 0.5, 0], "wall"),
        _box("lintel", [0, 2.55, -0.2], [WIDTH, HEIGHT, 0], "wall"),
        _quad("pane", [0, 0.5, -0.1], [WIDTH, 0, 0], [0, 2.05, 0], "glass"),
        _box("panel", [WIDTH - 0.03, 0.9, 2.2], [WIDTH, 2.1, 4.6], "panel"),
        _box("shelf", [0, 0, 1.2], [0.4, 0.8, 4.8], "wood"),
    ]
    parts += [
        _box("frame", [x - 0.03, 0.5, -0.13], [x + 0.03, 2.55, -0.07], "frame")
        for x in (0.03, 1.4, 2.8, 4.2, WIDTH - 0.03)
    ]
    return parts


def _furniture() -> list[Part]:
    left, right, far, near, top = TABLE
    parts = [_box("table", [left, top - 0.04, far], [right, top, near], "wood")]
    parts += [
        _box("foot", [2.5, 0, z], [3.1, top - 0.04, z + 0.08], "metal") for z in (far + 0.5, near - 0.58)
    ]
    for row in range(4):
        z = far + 0.5 + 0.93 * row
        for x, back in ((left - 0.5, left - 0.56), (right + 0.04, right + 0.5)):
            parts += [
                _box("seat", [x, 0.43, z - 0.23], [x + 0.46, 0.48, z + 0.23], "chair"),
                _box("back", [back, 0.5, z - 0.23], [back + 0.05, 0.9, z + 0.23], "chair"),
                _box("stem", [x + 0.21, 0, z - 0.03], [x + 0.26, 0.43, z + 0.03], "metal"),
            ]
    for x, z, turn in ((2.25, 2.3, 0), (3.35, 3.1, 0), (2.25, 4.2, 0)):
        parts.append(
            _box("sheet", [x - 0.11, top, z - 0.15], [x + 0.1 + turn, top + 0.003, z + 0.15], "ceiling")
        )
    for z in (1.7, 2.3, 4.3):
        sphere = {"type": "sphere", "centre": [0.2, 0.94, z], "radius": 0.14}
        parts.append({"name": "bowl", "shape": sphere, "kernel": "panel"})
    return parts


def _town() -> list[Part]:
    """Houses before the window, some of whose windows are lit."""
    random = np.random.default_rng(6)
    parts = [_quad("ground", [-400, -12, -600], [0, 0, 590], [800, 0, 0], "ground")]
    for number in range(26):
        x, z = -150 + 12.5 * number + random.uniform(-4, 4), -random.uniform(60, 160)
        wide, tall = random.uniform(8, 15), random.uniform(4, 26)
        parts.append(_box("house", [x, -12, z - 10], [x + wide, tall - 12, z], "house"))
        for _ in range(int(random.integers(0, 2))):
            u, v = random.uniform(1, wide - 2.5), random.uniform(1.5, max(tall - 3, 2))
            pane = _quad("lit window", [x + u, v - 12, z + 0.02], [1.3, 0, 0], [0, 1.5, 0], "house")
            pane["luminaire"] = {"radiance": {"blackbody": 2900, "luminance": 90}}
            parts.append(pane)
    return parts


def _write_sky(file: Path) -> None:
    """An evening sky: orange at the horizon, blue above, dark below."""
    down = np.pi * (np.arange(128) + 0.5)[:, None] / 128
    around = 2 * np.pi * (np.arange(256) + 0.5)[None, :] / 256 - np.pi
    above = np.clip(np.cos(down), 0, 1)
    glow = np.exp(-above / 0.12) * (0.55 + 0.45 * np.cos(around + 0.35))
    blue = 0.25 + 0.75 * np.exp(-above / 0.5)
    image = glow[..., None] * np.array([2.6, 1.15, 0.35]) + blue[..., None] * np.array([0.22, 0.34, 0.62])
    image = np.where((down < 0.5 * np.pi)[..., None], image, 0.02)
    picture = oiio.ImageBuf(oiio.ImageSpec(256, 128, 3, oiio.FLOAT))
    picture.set_pixels(oiio.ROI(), image.astype(np.float32))
    if not picture.write(str(file)):
        raise OSError(picture.geterror())


def _quad(name: str, corner: list[float], u: list[float], v: list[float], kernel: str) -> Part:
    shape = {"type": "quad", "corner": [round(float(each), 3) for each in corner], "edge_u": u, "edge_v": v}
    return {"name": name, "shape": shape, "kernel": kernel}


def _box(name: str, low: list[float], high: list[float], kernel: str) -> Part:
    rounded = ([round(float(each), 3) for each in corner] for corner in (low, high))
    return {
        "name": name,
        "shape": dict(zip(("type", "minimum", "maximum"), ("box", *rounded), strict=True)),
        "kernel": kernel,
    }


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
