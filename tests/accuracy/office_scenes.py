"""An office as a lighting engineer described it, and the places around it at which meters were tried.

The room is 6 m x 5 m x 2.8 m, y up, with a window of two panes in the wall z = 0, two desks and six recessed
luminaires, whose batwing of 3600 lm is in data/office.json; of it 0.8 is used. Its light is of a phosphor LED
of 4000 K. The Sun stands as over Stuttgart on 21 March at 9:00.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_scene.validation.documents import quad

Document = dict[str, Any]

OFFICE: Document = json.loads((Path(__file__).parent / "data" / "office.json").read_text())
SHARE = 0.8
"""Of the luminaires' flux, by their maintenance."""
FLUX = 3600.0
EDGE, HEIGHT = 0.6, 2.799
MIDDLES = [(x, z) for x in (1.0, 3.0, 5.0) for z in (1.25, 3.75)]
TO_SUN = (-0.7963087262569862, 0.3932675932786242, -0.4596009275053899)
SUN_LUMINANCE = 1099775613.2266104
SUN: Document = {
    "direction": [*TO_SUN],
    "radiance": {"illuminant": "D55", "luminance": SUN_LUMINANCE},
}
CLEAR_SKY: Document = {"cie": 12, "sun": [*TO_SUN], "illuminance": 12000}
WINDOW = (1.5, 4.5, 0.9, 2.3)
"""From and to, along x and y, m."""
PANES = (-0.004, -0.026)
REVEAL = 0.03
WORK_PLANE: Document = {
    "type": "irradiance_meter",
    "position": [3, 0.75, 2.5],
    "normal": [0, 1, 0],
    "up": [0, 0, 1],
    "height": 4,
}
_KERNELS: Document = {
    **{
        name: {"type": "lambertian", "reflectance": reflectance}
        for name, reflectance in (
            ("floor", 0.2),
            ("wall", 0.5),
            ("ceiling", 0.7),
            ("desk", 0.4),
            ("frame", 0.5),
            ("ground", 0.2),
        )
    },
    "glass": {"type": "thin_pane", "index": 1.52, "transmittance": 0.98},
}


def led() -> Document:
    """Blue and three further bells, relative power."""
    nm = np.arange(380.0, 781.0, 5.0)

    def bell(middle: float, below: float, above: float) -> "np.ndarray[Any, Any]":
        width = np.where(nm < middle, below, above)
        return np.asarray(np.exp(-(((nm - middle) / width) ** 2)))

    power = 1.12 * bell(450, 12, 14) + bell(580, 62, 75) + 0.3 * bell(620, 40, 40) + 0.12 * bell(500, 25, 25)
    return {"table": [[float(a), round(float(b), 5)] for a, b in zip(nm, power, strict=True)]}


def room(*, desks: bool, glass: bool = True) -> list[Document]:
    """Surfaces without luminaires; with the ground outside."""
    (left, right, low, high), r = WINDOW, REVEAL
    width, rise = right - left, high - low
    parts = [
        ("floor", "floor", quad([0, 0, 0], [0, 0, 5], [6, 0, 0])),
        ("ceiling", "ceiling", quad([0, 2.8, 0], [6, 0, 0], [0, 0, 5])),
        ("wall west", "wall", quad([0, 0, 0], [0, 2.8, 0], [0, 0, 5])),
        ("wall east", "wall", quad([6, 0, 0], [0, 0, 5], [0, 2.8, 0])),
        ("wall north", "wall", quad([0, 0, 5], [0, 2.8, 0], [6, 0, 0])),
        ("south below", "wall", quad([0, 0, 0], [6, 0, 0], [0, low, 0])),
        ("south above", "wall", quad([0, high, 0], [6, 0, 0], [0, 2.8 - high, 0])),
        ("south left", "wall", quad([0, low, 0], [left, 0, 0], [0, rise, 0])),
        ("south right", "wall", quad([right, low, 0], [6 - right, 0, 0], [0, rise, 0])),
        ("ground", "ground", quad([-60, -0.3, -100], [0, 0, 99.9], [120, 0, 0])),
    ]
    if glass:
        parts += [
            *((f"pane {z}", "glass", quad([left, low, z], [width, 0, 0], [0, rise, 0])) for z in PANES),
            ("reveal bottom", "frame", quad([left, low, -r], [0, 0, r], [width, 0, 0])),
            ("reveal top", "frame", quad([left, high, -r], [width, 0, 0], [0, 0, r])),
            ("reveal left", "frame", quad([left, low, -r], [0, rise, 0], [0, 0, r])),
            ("reveal right", "frame", quad([right, low, -r], [0, 0, r], [0, rise, 0])),
        ]
    if desks:
        for x in (1.2, 3.2):
            body = {"type": "box", "minimum": [x, 0.7, 1.4], "maximum": [x + 1.6, 0.73, 2.2]}
            parts.append((f"desk {x}", "desk", body))
    return [{"name": name, "shape": shape, "kernel": kernel} for name, kernel, shape in parts]


def luminaires(profile: str) -> list[Document]:
    """Six of a photometric file."""
    half = EDGE / 2
    return [
        {
            "name": f"luminaire {x:g} {z:g}",
            "shape": quad([x - half, HEIGHT, z - half], [EDGE, 0, 0], [0, 0, EDGE]),
            "kernel": "ceiling",
            "luminaire": {
                "radiance": "LED 4000 K",
                "profile": {"asset": profile, "lumens": SHARE * FLUX},
            },
        }
        for x, z in MIDDLES
    ]


def office(sensor: Document, surfaces: list[Document], **more: Any) -> Document:
    """With the room's materials."""
    used = {each["kernel"] for each in surfaces}
    return {
        "nocturne": 1,
        "spectra": {"LED 4000 K": led()},
        "kernels": {name: kernel for name, kernel in _KERNELS.items() if name in used},
        "sensor": sensor,
        "surfaces": surfaces,
        **more,
    }


def write_ies(folder: Path) -> str:
    """The luminaire by LM-63-2002; the file's name."""
    rows = [" ".join(f"{each:.3f}" for each in row) for row in OFFICE["intensity"]]
    head = f"IESNA:LM-63-2002\nTILT=NONE\n1 {FLUX:.0f} 1 19 3 1 2 {EDGE} {EDGE} 0\n1 1 30\n"
    angles = " ".join(f"{each:g}" for each in OFFICE["gamma"])
    (folder / "batwing.ies").write_text(f"{head}{angles}\n0 45 90\n" + "\n".join(rows) + "\n")
    return "batwing.ies"


def write_ldt(folder: Path) -> str:
    """The same by EULUMDAT, symmetric in both planes; the file's name."""
    lines = ["Example", "1", "4", "8", "45", "19", "5", "", "Office 600", "1", "batwing.ldt", "2026-11-29"]
    lines += ["600", "600", "60", "600", "600", "0", "0", "0", "0", "100", "100", "1", "0"]
    lines += ["1", "1", "LED", f"{FLUX:.0f}", "4000", "80", "30", *["0.5"] * 10]
    lines += [f"{45 * each}" for each in range(8)] + [f"{each:g}" for each in OFFICE["gamma"]]
    lines += [f"{each / (FLUX / 1000):.2f}" for row in OFFICE["intensity"] for each in row]
    (folder / "batwing.ldt").write_text("\r\n".join(lines) + "\r\n")
    return "batwing.ldt"
