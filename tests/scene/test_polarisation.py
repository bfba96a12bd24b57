"""Stokes channels and filters are compiled, and refused where photons don't know of polarisation."""

from typing import Any

import numpy as np
import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.responses import is_signed, light_groups_in, light_of, name_problems

from .conftest import Compile, Document, expect_problem

_FILTER = {"type": "polariser", "axis": [0, 3, 4]}


def _asking(document: Document, **more: Any) -> Document:
    document["sensor"] |= {"stokes": True, **more}
    return document


def test_each_channel_has_three_more(document: Document, compiled: Compile) -> None:
    bands = {"first": 400, "last": 700, "width": 150}
    sensor = compiled(_asking(document, responses={"eye": 1.0}, bands=bands)).sensor
    found = {each.name: each for each in sensor.further_responses}
    names = ["X", "Y", "Z", "eye", "475,000000nm", "625,000000nm"]
    stokes = [f"S{i}.{name}" for i in (1, 2, 3) for name in names]
    assert [name for name in found if is_signed(name) and name[0] == "S"] == stokes
    assert found["S2.Y"].values == sensor.response_y
    assert found["S3.475,000000nm"].values == found["S0.475,000000nm"].values
    assert [found[f"S{i}.eye"].stokes for i in (1, 2, 3)] == [1, 2, 3]
    assert not [*name_problems([*found])]
    assert light_groups_in([*found]) == []


def test_light_behind_polarisers_is_a_sum_of_values(document: Document, compiled: Compile) -> None:
    """Half of S0 + S1 cos 2a + S2 sin 2a (Malus's law), from values that lie before it."""
    sensor = compiled(_asking(document, responses={"eye": 1.0})).sensor
    names = ["X", "Y", "Z", *(each.name for each in sensor.further_responses)]
    values = dict(zip(names, np.random.default_rng(1).random(len(names)), strict=True))
    for place, response in enumerate(sensor.further_responses, start=3):
        if response.name.startswith("polariser"):
            layer, _, channel = response.name.partition(".")
            twice = np.radians(2 * {"polariser0": 0.0, "polariser22": 22.5, "polariser45": 45.0}[layer])
            behind = values[f"S1.{channel}"] * np.cos(twice) + values[f"S2.{channel}"] * np.sin(twice)
            found = sum(each.factor * values[names[each.value]] for each in response.terms)
            assert found == pytest.approx(0.5 * (values[channel] + behind), rel=1e-9)
            assert max(each.value for each in response.terms) < place
    told = [name for name in names if name.startswith("polariser")]
    assert told == [f"polariser{angle}.{name}" for name in ("Y", "eye") for angle in (0, 22, 45)]
    assert not [*name_problems(names[3:])]
    assert light_groups_in(names[3:]) == []
    light = [names[place] for place in light_of(names)]
    assert (light[names.index("S2.X")], light[names.index("polariser22.eye")]) == ("X", "eye")


@pytest.mark.parametrize(("bands", "behind"), [(6, 21), (7, 3), (12, 3)])
def test_there_is_room_for_twelve_bands(
    document: Document, compiled: Compile, bands: int, behind: int
) -> None:
    """With few of them each has polarisers; with more Y alone."""
    given = {"first": 400, "last": 400 + 25 * bands, "width": 25}
    names = [each.name for each in compiled(_asking(document, bands=given)).sensor.further_responses]
    assert len([name for name in names if name.startswith("polariser")]) == behind
    light = [*names[:bands], "X", "Y", "Z"]
    assert all(f"S{i}.{name.removeprefix('S0.')}" in names for i in (1, 2, 3) for name in light)


def test_a_polariser_has_its_axis(document: Document, compiled: Compile) -> None:
    document["surfaces"][0]["kernel"] = _FILTER | {"transmittance": 0.8, "leakage": 0.1}
    scene = compiled(document)
    found = scene.kernels[scene.surfaces[0].kernel].polarising_filter
    assert (found.axis.x, found.axis.y, found.axis.z) == pytest.approx((0.0, 0.6, 0.8))
    values = [scene.spectra[index].values[0] for index in (found.along, found.across, found.retardance)]
    assert values == pytest.approx([0.8, 0.1, 0.0])


def test_a_plate_retards_by_wavelength(document: Document, compiled: Compile) -> None:
    document["surfaces"][0]["kernel"] = {"type": "retarder", "axis": [1, 0, 0], "retardance_nm": 137.5}
    scene = compiled(document)
    found = scene.kernels[scene.surfaces[0].kernel].polarising_filter
    at = np.array([400.0, 550.0, 700.0])
    assert spectra.evaluate(scene.spectra[found.retardance], at) == pytest.approx(
        2 * np.pi * 137.5 / at, rel=1e-6
    )


@pytest.mark.parametrize(
    ("kernel", "place", "words"),
    [
        (_FILTER | {"axis": [0, 0, 0]}, ".axis", "no length"),
        ({"type": "retarder", "axis": [1, 0, 0]}, "", "retardance_nm"),
        (_FILTER | {"leakage": 1.5}, ".leakage", "[0, 1]"),
        ({"type": "mask", "kernel": _FILTER, "opacity": 0.5}, "", "polariser"),
    ],
)
def test_impossible_filters_are_refused(
    document: Document, blobs: BlobStore, kernel: Any, place: str, words: str
) -> None:
    document["surfaces"][0]["kernel"] = kernel
    expect_problem(document, blobs, f"$.surfaces[0].kernel{place}", words)


@pytest.mark.parametrize(("name", "value"), [("direction", "both"), ("sharing", 16)])
def test_only_photons_from_the_sensor_know(
    document: Document, blobs: BlobStore, name: str, value: Any
) -> None:
    document["tracing"] = {name: value}
    expect_problem(_asking(document), blobs, f"$.tracing.{name}", "polarised")


def test_no_parts_of_polarised_light(document: Document, blobs: BlobStore) -> None:
    expect_problem(_asking(document, light_parts=True), blobs, "$.sensor.stokes", "direct")


def test_what_depolarises_is_said(document: Document, blobs: BlobStore) -> None:
    document["surfaces"][0]["kernel"] = {"type": "phong", "reflectance": 0.5, "exponent": 10}
    assert not [
        each for each in compile_scene(check_document(document), blobs).warnings if "Phong" in each.sentence
    ]
    found = compile_scene(check_document(_asking(document)), blobs).warnings
    assert any("Phong lobes leave light unpolarised" in each.sentence for each in found)


def _with_phase(document: Document, phase: Any) -> Document:
    document["media"] = {"fog": {"scattering": 1.0, "phase": phase}}
    document["unbounded_media"] = ["fog"]
    return document


_TABLE: Document = {"type": "tabulated", "cosines": [-1, 0, 1], "values": [[1.0, 0.5, 2.0]]}
_MATRIX = {"s12": [[0.0, -0.4, 0.0]], "s33": [[-1.0, 0.3, 1.0]], "s34": [[0.0, 0.2, 0.0]]}


def test_a_phase_matrix_is_for_polarised_light_alone(document: Document, compiled: Compile) -> None:
    document = _with_phase(document, _TABLE | {"matrix": _MATRIX})
    assert not compiled(document).media[0].phase.tabulated.s12
    found = compiled(_asking(document)).media[0].phase.tabulated
    assert [list(each) for each in (found.s12, found.s33, found.s34)] == [
        pytest.approx(_MATRIX[name][0]) for name in ("s12", "s33", "s34")
    ]
    assert not found.s22
    assert not found.s44


def test_media_without_a_matrix_are_said(document: Document, blobs: BlobStore) -> None:
    def said(phase: Any) -> bool:
        asked = _asking(_with_phase(document, phase))
        return any(
            each.sentence.startswith("$.media: media leave light unpolarised")
            for each in compile_scene(check_document(asked), blobs).warnings
        )

    assert said(_TABLE)
    assert said({"type": "henyey_greenstein", "g": 0.5})
    assert not said(_TABLE | {"matrix": _MATRIX})
    assert not said({"type": "rayleigh"})
    # Ozone absorbs, and scatters nothing.
    document["atmosphere"] = {"ozone": {}}
    assert not said({"type": "rayleigh"})


@pytest.mark.parametrize(
    ("changed", "place", "words"),
    [
        ({"s12": [[0.0, -0.4]]}, "s12", "3 values"),
        ({"s44": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]}, "s44", "1 lists"),
        ({"s12": [[0.0, -1.4, 0.0]]}, "s12[0][1]", "-1"),
        ({"s12": [[0.0, -0.9, 0.0]], "s33": [[-1.0, 0.9, 1.0]]}, "s12[0][1]", "more than wholly polarised"),
        ({"s12": [[0.5, 0.0, 0.0]], "s22": [[0.2, 1.0, 1.0]]}, "s12[0][0]", "more than wholly polarised"),
    ],
)
def test_impossible_matrices_are_refused(
    document: Document, blobs: BlobStore, changed: Any, place: str, words: str
) -> None:
    document = _with_phase(document, _TABLE | {"matrix": _MATRIX | changed})
    expect_problem(document, blobs, f"$.media.fog.phase.matrix.{place}", words)
