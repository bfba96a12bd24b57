"""Photometric files of types A and B send their light where LM-63-2002, section 3, says."""

from pathlib import Path

import numpy as np
import pytest

from tests.accuracy.tracing import Document, part_of, trace

_VERTICAL = [-90, -60, -30, 0, 20, 30, 40, 60, 90]
_HORIZONTAL = [-90, -60, -30, 0, 20, 30, 40, 60, 90]


def _write(path: Path, kind: int, at: tuple[int, int]) -> None:
    """1000 cd at a vertical and a horizontal angle, and none at others."""
    rows = [["1000" if (v, h) == at else "0" for v in _VERTICAL] for h in _HORIZONTAL]
    angles = [" ".join(map(str, each)) for each in (_VERTICAL, _HORIZONTAL)]
    body = "\n".join([*angles, *(" ".join(row) for row in rows)])
    path.write_text(f"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 9 9 {kind} 2 0 0 0\n1 1 10\n{body}\n")


def _lamp() -> Document:
    ball = {"type": "sphere", "centre": [0, 0, 0], "radius": 0.1}
    light = {"radiance": {"illuminant": "D65", "luminance": 1}, "profile": {"asset": "lamp.ies"}}
    black = {"type": "lambertian", "reflectance": 0}
    return {
        "nocturne": 1,
        "sensor": {"type": "intensity_meter", "position": [0, 0, 0], "lamp_radius": 0.3},
        "surfaces": [{"shape": ball, "kernel": black, "luminaire": light}],
    }


@pytest.mark.parametrize(
    ("kind", "at", "gamma", "c"),
    [
        # Type B: (0, 0) is straight down; vertical angles go to C0, horizontal ones clockwise from above.
        (2, (30, 0), 30, 0),
        (2, (0, 30), 30, 270),
        (
            2,
            (30, 30),
            np.degrees(np.arccos(0.75)),
            360 - np.degrees(np.arctan2(0.5, np.cos(np.pi / 6) * 0.5)),
        ),
        # Type A: (0, 0) is level towards C0; vertical angles go up.
        (3, (30, 0), 120, 0),
        (3, (0, 30), 90, 330),
        (3, (30, 30), 120, 330),
    ],
)
def test_light_goes_where_the_file_says(
    tmp_path: Path, kind: int, at: tuple[int, int], gamma: float, c: float
) -> None:
    _write(tmp_path / "lamp.ies", kind, at)
    image = trace(_lamp(), tmp_path, (72, 36), part_of(1024))
    rows = (np.arange(36) + 0.5) * np.pi / 36
    around = (np.arange(72) + 0.5) * 2 * np.pi / 72
    flux = image.y * np.sin(rows)[:, None]
    sine = np.sin(rows)[:, None]
    mean = np.array(
        [
            (flux * sine * np.cos(around)).sum(),
            (flux * sine * np.sin(around)).sum(),
            (flux * np.cos(rows)[:, None]).sum(),
        ]
    )
    expected = np.array(
        [
            np.sin(np.radians(gamma)) * np.cos(np.radians(c)),
            np.sin(np.radians(gamma)) * np.sin(np.radians(c)),
            np.cos(np.radians(gamma)),
        ]
    )
    # The spot of 20 degrees is not the same on all sides of its middle.
    assert np.degrees(np.arccos(expected @ mean / np.linalg.norm(mean))) < 4
