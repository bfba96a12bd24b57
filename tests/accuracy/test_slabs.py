"""Plates of glass: one, absorbing or clear, as a body and as one surface, and piles of them.

Sums over all inner reflections without interference, unpolarised at every bounce (keeping s and p apart
would transmit more: 1.5 % at 60 degrees): Stokes, Proc. Royal Society 11, 1862. Standard errors come from 64
pixels; z values within the Sidak bound of all of this file's, false alarms 0.01.
"""

from itertools import product
from math import exp
from pathlib import Path
from typing import Any

import pytest
from nocturne_scene.validation.documents import BLACK

from tests.accuracy.agreement import sidak_bound
from tests.accuracy.spectral_meters import beam, level, measure, scene, slab
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

# Index, optical thickness along the normal: transmittance and reflectance by angle, degrees.
PLATES = {
    (1.52, 0.0): {
        0: (0.91831803, 0.081681972),
        15: (0.91816505, 0.081834951),
        30: (0.91544553, 0.084554472),
        45: (0.89925365, 0.10074635),
        60: (0.8306926, 0.1693074),
        75: (0.59145026, 0.40854974),
        85: (0.23844877, 0.76155123),
    },
    (1.5168, 0.0): {
        0: (0.91908272, 0.080917283),
        15: (0.9189303, 0.081069702),
        30: (0.91621957, 0.083780428),
        45: (0.9000659, 0.099934096),
        60: (0.83157163, 0.16842837),
        75: (0.59217429, 0.40782571),
        85: (0.23869859, 0.76130141),
    },
    (1.8, 0.05): {
        0: (0.80713235, 0.14430759),
        15: (0.80653706, 0.1444082),
        30: (0.8024215, 0.14709473),
        45: (0.78437017, 0.16299788),
        60: (0.71895575, 0.22607921),
        75: (0.51015587, 0.43365005),
        85: (0.19939659, 0.74758414),
    },
}

# Index, number of plates: transmittance at normal incidence, (1 - r) / (1 + (2 m - 1) r).
PILES = {(1.5, 2): 0.85714286, (1.5, 10): 0.54545455, (1.7, 20): 0.25757576}

_BOUND = sidak_bound(111)
_WIDE = 20.0
"""Half the edge of a plate of 1 m, m. Photons leave a surface by 1e-6 of its size, which absorbs nothing."""


def _one_sided(surfaces: list[Document], angle: float, below: bool, **tracing: Any) -> Document:
    """Light from below or from above only."""
    dark = level(100.0 if below else -100.0, 1e6, BLACK)
    return scene(beam(angle), [*surfaces, dark], **tracing)


@pytest.mark.parametrize("kind", ["body", "pane"])
@pytest.mark.parametrize(("index", "absorbed"), PLATES)
def test_a_plate(kind: str, index: float, absorbed: float, tmp_path: Path) -> None:
    """Standard errors: 0.02 % to 0.5 %."""
    if kind == "body":
        plate = slab(-1.0, 0.0, _WIDE, {"type": "dielectric", "index": index, "absorption": absorbed})
    else:
        plate = level(0.0, _WIDE, {"type": "thin_pane", "index": index, "transmittance": exp(-absorbed)})
    for angle, truths in PLATES[index, absorbed].items():
        for below, truth in zip((True, False), truths, strict=True):
            what = f"{kind}, n {index}, {angle} deg, {'through' if below else 'back'}"
            document = _one_sided([plate], angle, below)
            measure(document, tmp_path, 512).check(truth, _BOUND, what)


@pytest.mark.parametrize(
    "tracing",
    [
        {"estimator": "mixture"},
        {"estimator": "split"},
        {"photons_together": 1},
        {"sequence": "independent"},
        {"h": 1e6},
        {"h": 0.5},
        {"roulette": "albedo"},
    ],
    ids=str,
)
def test_however_it_is_traced(tracing: dict[str, Any], tmp_path: Path) -> None:
    """The absorbing plate at 60 degrees."""
    plate = slab(-1.0, 0.0, _WIDE, {"type": "dielectric", "index": 1.8, "absorption": 0.05})
    for below, truth in zip((True, False), PLATES[1.8, 0.05][60], strict=True):
        measure(_one_sided([plate], 60, below, **tracing), tmp_path, 1024).check(truth, _BOUND, tracing)


def test_what_light_passes_straight_through_is_no_interaction(tmp_path: Path) -> None:
    """Three panes; with one interaction at most, light that is mirrored between them does not arrive."""
    panes = [level(-float(i), _WIDE, {"type": "thin_pane", "index": 1.52}) for i in range(3)]
    document = _one_sided(panes, 0, True, maximum_depth=1)
    measure(document, tmp_path, 512).check(PLATES[1.52, 0.0][0][0] ** 3, _BOUND, "three panes")


@pytest.mark.parametrize(("index", "plates"), PILES)
@pytest.mark.parametrize("thickness", [1.0, 1e-6])
def test_a_pile(index: float, plates: int, thickness: float, tmp_path: Path) -> None:
    """Plates and gaps of the same thickness, down to a micrometre: nothing is lost between them."""
    glass = {"type": "dielectric", "index": index}
    half_edge = 10.0 if thickness == 1.0 else 0.01
    pile = [slab(-(2 * i + 1) * thickness, -2 * i * thickness, half_edge, glass) for i in range(plates)]
    estimate = measure(_one_sided(pile, 0, True), tmp_path, 1024)
    estimate.check(PILES[index, plates], _BOUND, f"{plates} plates of {thickness} m")


def _stack(*ratios: float) -> float:
    """Transmittance of boundaries by their ratios of indices, at normal incidence: reciprocals add up."""
    reflected = [((n - 1.0) / (n + 1.0)) ** 2 for n in ratios]
    return 1.0 / (1.0 + sum(r / (1.0 - r) for r in reflected))


@pytest.mark.parametrize(
    ("reach", "truth"),
    [
        pytest.param(1e-6, _stack(1.5, 1.5 / 1.33, 1.33), id="water reaches into the glass"),
        pytest.param(1e-3, _stack(1.5, 1.5 / 1.33, 1.33), id="water reaches far into the glass"),
        pytest.param(-1e-6, _stack(1.5, 1.5, 1.33, 1.33), id="a gap of air"),
        pytest.param(0.0, _stack(1.5, 1.5 / 1.33, 1.33), id="touching"),
    ],
)
@pytest.mark.parametrize("first", ["glass", "water"])
def test_water_in_glass(reach: float, truth: float, first: str, tmp_path: Path) -> None:
    """Glass above water, in the document in either order."""
    glass = slab(0.0, 1.0, 0.01, {"type": "dielectric", "index": 1.5, "priority": 1})
    water = slab(-1.0, reach, 0.01, {"type": "dielectric", "index": 1.33})
    bodies = [glass, water] if first == "glass" else [water, glass]
    document = _one_sided(bodies, 0, True)
    document["sensor"] |= {"position": [0, 0, 3]}
    estimate = measure(document, tmp_path, 1024)
    estimate.check(truth, _BOUND, (reach, first))
    assert estimate.error < 2e-3


def test_index_1_is_invisible(tmp_path: Path) -> None:
    """Every photon goes on in the same direction, so the image is that without the body, to rounding."""
    for index, angle in product([1.0], [0, 45, 89]):
        body = slab(-1.0, 0.0, _WIDE, {"type": "dielectric", "index": index})
        estimate = measure(_one_sided([body], angle, True), tmp_path, 64)
        reference = measure(_one_sided([], angle, True), tmp_path, 64)
        assert estimate == reference
