"""Media that overlap against the one medium that they add up to, in images by z-tests.

False alarms: 0.01 for the pixels, 0.01 for the tiles and 0.003 for the mean of each test.
"""

from pathlib import Path
from typing import Any

import pytest

from tests.accuracy.agreement import compare
from tests.accuracy.tracing import IN_FULL, Document, trace

_EDGE, _SAMPLES = (16 if IN_FULL else 8), 256

_PROFILE: Document = {"layers": [[-3, 1.6], [3, 0.4]], "above": {"point": [0, 0, 0], "up": [0, 0, 1]}}
"""Along the view, of all media here, so that sums of them have it too; nothing beyond 3 m."""

_ABSORPTION = {
    "air": [[400, 0.0], [700, 0.02]],
    "smoke": [[400, 0.4], [700, 0.1]],
    "fog": [[400, 0.0], [700, 0.1]],
}
_SCATTERING = {"air": 0.3, "smoke": 0.3, "fog": 0.6}
"""Factors of one spectrum: shares in a sum are the same at all wavelengths, as mixed phase functions need."""


def _sum(*names: str) -> Document:
    """A medium by itself, or what some add up to: air scatters evenly, the others forwards."""
    lit = sum(_SCATTERING[name] for name in names)
    absorbed = [[nm, sum(_ABSORPTION[name][knot][1] for name in names)] for knot, nm in enumerate((400, 700))]
    return {
        "absorption": {"table": absorbed},
        "scattering": {"table": [[400, 1.3 * lit], [700, 0.7 * lit]]},
        "phase": {
            "type": "double_henyey_greenstein",
            "first": 0.0,
            "second": 0.6,
            "weight": (_SCATTERING["air"] if "air" in names else 0.0) / lit,
        },
        "density": _PROFILE,
    }


def _scene(media: Document, surfaces: list[Document], seed: int, **more: Any) -> Document:
    # Even light shows absorption, and a black ball behind the media shows scattering.
    ball = {
        "shape": {"type": "sphere", "centre": [0, 0, -2], "radius": 0.8},
        "kernel": {"type": "lambertian", "reflectance": 0},
    }
    return {
        "nocturne": 1,
        "media": media,
        "environment": {"radiance": 1.0},
        "sensor": {
            "type": "pinhole",
            "position": [0.3, 0.4, 3.5],
            "look_at": [0, 0, 0],
            "vertical_field_of_view_degrees": 32,
        },
        "surfaces": [*surfaces, ball],
        "tracing": {"seed": seed, "sequence": "independent"},
        **more,
    }


def _body(shape: Document, medium: str, **more: Any) -> Document:
    return {"shape": shape, "interior": {"media": [medium]}, **more}


def _box(low: float, high: float) -> Document:
    return {"type": "box", "minimum": [low, -1, -1], "maximum": [high, 1, 1]}


_BALL: Document = {"type": "sphere", "centre": [0.2, 0.1, 0], "radius": 0.6}


@pytest.mark.parametrize("photons", [1, 4])
def test_fog_in_smoke_in_air(photons: int, tmp_path: Path) -> None:
    """A bank of fog in a cloud of smoke in air that is everywhere, against bodies of one medium each.

    The bodies have index 1: light passes them unbent, and they displace the media around them.
    """
    names = {name: _sum(name) for name in _SCATTERING}
    over = _scene(names, [_body(_box(-1, 1), "smoke"), _body(_BALL, "fog")], 1, unbounded_media=["air"])
    sums = {"air": _sum("air"), "two": _sum("air", "smoke"), "three": _sum("air", "smoke", "fog")}
    clear: Document = {"type": "dielectric", "index": 1.0}
    bodies = [
        _body(_box(-1, 1), "two", kernel=clear),
        _body(_BALL, "three", kernel={**clear, "priority": 1}),
    ]
    apart = _scene(sums, bodies, 2, unbounded_media=["air"])
    _check(over, apart, photons, tmp_path)


@pytest.mark.parametrize("photons", [1, 4])
def test_bodies_that_overlap_in_part(photons: int, tmp_path: Path) -> None:
    """Two boxes that share a third of their room, against three that share none."""
    two = [_body(_box(-1, 0.3), "smoke"), _body(_box(-0.3, 1), "fog")]
    over = _scene({name: _sum(name) for name in ("smoke", "fog")}, two, 1)
    three = [_body(_box(-1, -0.3), "smoke"), _body(_box(-0.3, 0.3), "both"), _body(_box(0.3, 1), "fog")]
    media = {"smoke": _sum("smoke"), "fog": _sum("fog"), "both": _sum("smoke", "fog")}
    _check(over, _scene(media, three, 2), photons, tmp_path)


def _check(one: Document, other: Document, photons: int, folder: Path) -> None:
    images = []
    for name, document in (("one", one), ("other", other)):
        (folder / name).mkdir()
        together = {**document["tracing"], "photons_together": photons}
        images.append(trace({**document, "tracing": together}, folder / name, _EDGE, _SAMPLES))
    assert images[0].y.min() > 0.0
    compare(images[0], images[1]).check()
