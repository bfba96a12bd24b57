"""Writes the documents of this office and the photometric file of its luminaires next to itself, or into a
folder.

6 m by 4.8 m, 2.8 m high; x to the east, y up, z to the south, where the window is.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

WIDTH, HEIGHT, DEPTH = 6.0, 2.8, 4.8  # m
LUMENS, MAINTENANCE = 3400.0, 0.8
SIDE = 0.6  # m, of a luminaire

Part = dict[str, Any]


def main(folder: Path) -> None:
    """Write office.ies, scene.json, eye.json, view.json and daylight.json into `folder`."""
    (folder / "office.ies").write_text(luminaire_file(), newline="")
    eye = {"type": "panorama", "position": [5.2, 1.2, 1.9], "look_at": [0, 1.2, 1.9]}
    view = {
        "type": "pinhole",
        "position": [5.75, 1.75, 0.3],
        "look_at": [2.3, 1.15, 3.6],
        "vertical_field_of_view_degrees": 58,
    }
    sky = {"cie": 16, "illuminance": 10000}
    for name, document in (
        ("scene", office("Office, evening", meters(colour=True))),
        ("eye", office("Office, an eye at the east wall", eye)),
        ("view", office("Office, with daylight", view, sky)),
        ("daylight", office("Office, overcast day", meters(outdoor=True), sky, lit=False)),
    ):
        (folder / f"{name}.json").write_text(_text(document))


def office(name: str, sensor: Part, sky: Part | None = None, *, lit: bool = True) -> Part:
    """A scene document."""
    grey = {
        key: {"type": "lambertian", "reflectance": value}
        for key, value in {
            "floor": 0.2,
            "walls": 0.6,
            "ceiling": 0.8,
            "wood": 0.45,
            "cloth": 0.25,
            "screen": 0.08,
            "frame": 0.7,
            "ground": 0.2,
        }.items()
    }
    document: Part = {
        "nocturne": 1,
        "name": name,
        "kernels": grey | {"glass": {"type": "thin_pane", "index": 1.52, "transmittance": 0.97}},
        "sensor": sensor,
        "surfaces": room() + furniture(),
    }
    if lit:
        document["groups"] = {"luminaire": [luminaire()]}
        places = [(x, z) for x in (1.2, 3.0, 4.8) for z in (1.2, 3.3)]
        document["instances"] = [
            {"group": "luminaire", "translate": [x, HEIGHT - 0.002, z]} for x, z in places
        ]
    if sky is not None:
        document["environment"] = sky
    return document


def meters(*, outdoor: bool = False, colour: bool = False) -> Part:
    """The working plane without 0.5 m at the walls, faces, and the roof."""
    level = [0, 0.75, DEPTH], [WIDTH, 0, 0], [0, 0, -DEPTH]
    grid = dict(zip(("corner", "right", "up"), level, strict=True))
    faces = grid | {"corner": [0, 1.2, DEPTH], "border": 0.5, "columns": 5, "rows": 4}
    instruments: list[Part] = [{"name": "working plane", "grid": grid | {"border": 0.5}}]
    if outdoor:
        roof = {"name": "roof", "points": [[3, 12, 2.4]]}
        return {"type": "meters", "instruments": [*instruments, roof], "outdoor": "roof"}
    instruments.append({"name": "faces", "grid": faces, "measures": "cylindrical"})
    return {"type": "meters", "instruments": instruments, "colour": colour}


def luminaire() -> Part:
    """Its light comes from a square that faces down, at the origin."""
    half = SIDE / 2
    quad = {"type": "quad", "corner": [-half, 0, -half], "edge_u": [SIDE, 0, 0], "edge_v": [0, 0, SIDE]}
    light = {
        "radiance": {"illuminant": "LED-B3"},
        "profile": {"asset": "office.ies"},
        "maintenance_factor": MAINTENANCE,
    }
    return {"name": "luminaire", "shape": quad, "kernel": "ceiling", "luminaire": light}


def room() -> list[Part]:
    """Walls with a window of 4 m by 1.3 m to the south, and the ground before it."""
    left, right, sill, top = 1.0, 5.0, 0.9, 2.2
    quads: list[tuple[str, list[float], list[float], list[float], str]] = [
        ("floor", [0, 0, 0], [0, 0, DEPTH], [WIDTH, 0, 0], "floor"),
        ("ceiling", [0, HEIGHT, 0], [WIDTH, 0, 0], [0, 0, DEPTH], "ceiling"),
        ("north wall", [0, 0, 0], [WIDTH, 0, 0], [0, HEIGHT, 0], "walls"),
        ("west wall", [0, 0, 0], [0, HEIGHT, 0], [0, 0, DEPTH], "walls"),
        ("east wall", [WIDTH, 0, 0], [0, 0, DEPTH], [0, HEIGHT, 0], "walls"),
        ("ground", [-2000, -0.4, DEPTH + 0.3], [0, 0, 4000], [4000, 0, 0], "ground"),
    ]
    parts = [_quad(*each) for each in quads]
    # The south wall is 0.3 m thick.
    wall = [
        ("wall below", [0, 0, DEPTH], [WIDTH, sill, DEPTH + 0.3]),
        ("wall above", [0, top, DEPTH], [WIDTH, HEIGHT, DEPTH + 0.3]),
        ("wall left", [0, sill, DEPTH], [left, top, DEPTH + 0.3]),
        ("wall right", [right, sill, DEPTH], [WIDTH, top, DEPTH + 0.3]),
    ]
    parts += [_box(name, low, high, "walls") for name, low, high in wall]
    for place in (DEPTH + 0.15, DEPTH + 0.17):
        pane = [left, sill, place], [right - left, 0, 0], [0, top - sill, 0]
        parts.append(_quad("pane", *pane, "glass"))
    for x in (left, 0.5 * (left + right) - 0.03, right - 0.06):
        parts.append(_box("frame", [x, sill, DEPTH + 0.12], [x + 0.06, top, DEPTH + 0.2], "frame"))
    return parts


def furniture() -> list[Part]:
    """Two desks with screens, two chairs, a cupboard."""
    parts = [_box("cupboard", [0.05, 0, 0.05], [2.05, 1.1, 0.5], "wood")]
    for name, x in (("west", 1.3), ("east", 3.5)):
        parts += [
            _box(f"{name} desk", [x, 0.71, 2.6], [x + 1.6, 0.735, 3.4], "wood"),
            _box(f"{name} desk, side", [x, 0, 2.65], [x + 0.03, 0.71, 3.35], "wood"),
            _box(f"{name} desk, side", [x + 1.57, 0, 2.65], [x + 1.6, 0.71, 3.35], "wood"),
            _box(f"{name} screen", [x + 0.5, 0.85, 3.2], [x + 1.1, 1.2, 3.22], "screen"),
            _box(f"{name} screen, foot", [x + 0.77, 0.735, 3.205], [x + 0.83, 0.85, 3.215], "screen"),
            _box(f"{name} chair, foot", [x + 0.77, 0, 2.12], [x + 0.83, 0.42, 2.18], "screen"),
            _box(f"{name} chair, seat", [x + 0.55, 0.42, 1.9], [x + 1.05, 0.48, 2.4], "cloth"),
            _box(f"{name} chair, back", [x + 0.55, 0.5, 1.86], [x + 1.05, 0.72, 1.9], "cloth"),
        ]
    return parts


def luminaire_file() -> str:
    """LM-63-2002: downwards, wider across (plane 0) than along (plane 90), dark beyond 75 degrees."""
    gamma, planes = np.arange(0, 91, 5), (0, 45, 90)
    shapes = []
    for plane in planes:
        peak = 34.0 - 8.0 * plane / 90.0
        bow = 0.5 + 0.8 * np.exp(-(((gamma - peak) / 20.0) ** 2))
        fade = 0.5 * (1.0 + np.cos(np.pi * np.clip((gamma - 52.0) / 23.0, 0.0, 1.0)))
        shapes.append(bow * np.cos(np.deg2rad(gamma)) * fade)
    # Straight down all planes are one.
    table = np.array(shapes)
    table[:, 0] = table[:, 0].mean()
    fine = np.deg2rad(np.linspace(0, 90, 3601))
    around = [np.trapezoid(np.interp(fine, np.deg2rad(gamma), row) * np.sin(fine), fine) for row in table]
    table *= LUMENS / (4.0 * np.trapezoid(around, np.deg2rad(planes)))
    lines = ["IESNA:LM-63-2002", "[TEST] computed, not measured", "[MANUFAC] Nocturne examples"]
    lines += ["[LUMCAT] OFFICE-600", "[LUMINAIRE] 600 x 600 mm, recessed", "TILT=NONE"]
    lines += [f"1 -1 1 {len(gamma)} {len(planes)} 1 2 {SIDE} {SIDE} 0", "1 1 29"]
    lines += [" ".join(f"{each}" for each in gamma), " ".join(f"{each}" for each in planes)]
    lines += [" ".join(f"{each:.1f}" for each in row) for row in table]
    return "\r\n".join(lines) + "\r\n"


def _quad(name: str, corner: list[float], u: list[float], v: list[float], kernel: str) -> Part:
    return {
        "name": name,
        "shape": {"type": "quad", "corner": corner, "edge_u": u, "edge_v": v},
        "kernel": kernel,
    }


def _box(name: str, low: list[float], high: list[float], kernel: str) -> Part:
    rounded = ([round(each, 4) for each in corner] for corner in (low, high))
    shape = dict(zip(("type", "minimum", "maximum"), ("box", *rounded), strict=True))
    return {"name": name, "shape": shape, "kernel": kernel}


def _text(document: Part) -> str:
    """JSON with a line for each surface and instance."""
    told = {key: value for key, value in document.items() if key not in ("surfaces", "instances")}
    text = json.dumps(told, indent=2)[:-2]
    for key in ("surfaces", "instances"):
        if key in document:
            rows = ",\n    ".join(json.dumps(each) for each in document[key])
            text += f',\n  "{key}": [\n    {rows}\n  ]'
    return text + "\n}\n"


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
