"""Fluorescent surfaces are compiled, and refused where they would make photons."""

from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra

from .conftest import Compile, expect_problem

_DYE = {
    "absorption": {"table": [[380, 0.2], [450, 0.5], [520, 0.0]]},
    "emission": {"table": [[480, 0.0], [530, 2.0], [650, 0.0]]},
}
_MATRIX = {
    "excitation_nm": [400, 450, 500],
    "emission_nm": [500, 550, 600],
    "values": [[1e-3, 2e-3, 1e-3], [2e-3, 4e-3, 1e-3], [0, 3e-3, 2e-3]],
}


def _with(
    document: dict[str, Any], *fluorescence: Any, reflectance: Any = 0.3, **more: Any
) -> dict[str, Any]:
    kernel = {"type": "lambertian", "reflectance": reflectance, "fluorescence": list(fluorescence)}
    document["surfaces"][0]["kernel"] = kernel
    return document | more


def _fluorescent(scene: scene_pb2.CompiledScene) -> scene_pb2.Fluorescent:
    return scene.kernels[scene.surfaces[0].kernel].fluorescent


def test_a_dye_emits_its_yield_in_photons(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(_with(document, _DYE | {"quantum_yield": 0.7}))
    (found,) = _fluorescent(scene).fluorophores
    nm = np.arange(360.0, 830.0, 0.01)
    emission = spectra.evaluate(scene.spectra[found.emission], nm)
    assert np.trapezoid(emission * nm, nm) == pytest.approx(0.7, rel=1e-5)
    assert spectra.evaluate(
        scene.spectra[found.absorption], np.array([370.0, 415.0, 530.0])
    ) == pytest.approx([0.0, 0.35, 0.0], abs=1e-6)


def test_a_matrix_is_a_sum_over_emitted_wavelengths(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(_with(document, _MATRIX))
    into, out = np.array([400.0, 450.0, 500.0]), np.array([500.0, 525.0, 550.0, 600.0])
    total = np.zeros((3, 4))
    for each in _fluorescent(scene).fluorophores:
        absorption = spectra.evaluate(scene.spectra[each.absorption], into)
        total += np.outer(absorption * into, spectra.evaluate(scene.spectra[each.emission], out))
    rows = np.array(_MATRIX["values"])
    between = 0.5 * (rows[:, 0] + rows[:, 1])
    expected = np.column_stack([rows[:, 0], between, rows[:, 1], rows[:, 2]])
    assert total == pytest.approx(expected, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("fluorescence", "reflectance", "place", "words"),
    [
        ([_DYE, _DYE], 0.3, ".fluorescence", "1.3"),
        ([_DYE], {"table": [[400, 0.2], [450, 0.6], [500, 0.2]]}, ".fluorescence", "450 nm"),
        ([_MATRIX, _MATRIX, _MATRIX], 0.2, ".fluorescence", "at most 1"),
        ([_DYE | {"emission": 0.5}], 0.3, ".fluorescence[0].emission", "table"),
        ([_DYE | {"emission": {"table": [[500, 0], [600, 0]]}}], 0.3, ".fluorescence[0].emission", "nothing"),
        ([_DYE | {"absorption": {"blackbody": 3000}}], 0.3, ".fluorescence[0].absorption", "part"),
        ([_DYE | {"absorption": {"table": [[200, 0.5], [300, 0.5]]}}], 0.3, ".fluorescence", "360 to 830 nm"),
        ([_DYE | {"emission": {"table": [[830, 0], [900, 1]]}}], 0.3, ".fluorescence", "360 to 830 nm"),
    ],
)
def test_impossible_fluorescence_is_refused(
    document: dict[str, Any],
    blobs: BlobStore,
    fluorescence: list[Any],
    reflectance: Any,
    place: str,
    words: str,
) -> None:
    scene = _with(document, *fluorescence, reflectance=reflectance)
    expect_problem(scene, blobs, f"$.surfaces[0].kernel{place}", words)


def test_the_last_wavelength_of_a_scene_excites_nothing(document: dict[str, Any], blobs: BlobStore) -> None:
    """A matrix from 400 nm on in a scene up to 400 nm was refused by the tracer, without a place."""
    scene = _with(document, _MATRIX, wavelengths={"first": 280, "last": 400})
    scene["sensor"]["measures"] = "erythemal"
    expect_problem(scene, blobs, "$.surfaces[0].kernel.fluorescence", "280 to 400 nm")


@pytest.mark.parametrize(("name", "value"), [("direction", "both"), ("sharing", 16)])
def test_photons_start_at_the_sensor_and_are_not_shared(
    document: dict[str, Any], blobs: BlobStore, name: str, value: Any
) -> None:
    scene = _with(document, _DYE, tracing={name: value})
    expect_problem(scene, blobs, f"$.tracing.{name}", "fluoresce")


def test_no_part_of_a_mask_fluoresces(document: dict[str, Any], blobs: BlobStore) -> None:
    document = _with(document, _DYE)
    kernel = document["surfaces"][0]["kernel"]
    document["surfaces"][0]["kernel"] = {"type": "mask", "kernel": kernel, "opacity": 0.5}
    expect_problem(document, blobs, "$.surfaces[0].kernel", "fluorescent")


def test_rows_and_columns_fit(document: dict[str, Any], blobs: BlobStore) -> None:
    wrong = _with(document, _MATRIX | {"emission_nm": [500, 550]})
    expect_problem(wrong, blobs, "$.surfaces[0].kernel.fluorescence[0].values[0]", "values")


_TINT = {
    "absorption": {"table": [[400, 0.0], [450, 3.0], [500, 0.0]]},
    "emission": {"table": [[520, 0.0], [560, 1.0], [640, 0.0]]},
    "quantum_yield": 0.9,
}


def _dyed(document: dict[str, Any], **medium: Any) -> dict[str, Any]:
    document["media"] = {"dye": medium}
    document["unbounded_media"] = ["dye"]
    return document


def test_a_dye_in_a_medium(document: dict[str, Any], compiled: Compile) -> None:
    """Its absorption is part of the medium's, and it emits its yield in photons. Where it is clear photons
    collide half as often as light of the same power at all wavelengths would be emitted."""
    scene = compiled(_dyed(document, fluorescence=[_TINT], absorption=0.5, scattering=0.25))
    (medium,) = scene.media
    (dye,) = medium.fluorophores
    at = np.array([425.0, 450.0, 560.0, 600.0])
    assert spectra.evaluate(scene.spectra[medium.absorption], at) == pytest.approx([2.0, 3.5, 0.5, 0.5])
    assert spectra.evaluate(scene.spectra[dye.absorption], at) == pytest.approx([1.5, 3.0, 0.0, 0.0])
    nm = np.arange(360.0, 830.0, 0.01)
    emission = spectra.evaluate(scene.spectra[dye.emission], nm)
    assert np.trapezoid(emission * nm, nm) == pytest.approx(0.9, rel=1e-5)
    excitation = np.trapezoid(spectra.evaluate(scene.spectra[dye.absorption], nm) * nm, nm)
    emitted = excitation * spectra.evaluate(scene.spectra[dye.emission], at)
    null = spectra.evaluate(scene.spectra[medium.null_collisions], at)
    assert null == pytest.approx(np.maximum(0.0, 0.5 * emitted - [2.25, 3.75, 0.75, 0.75]), rel=1e-3)
    assert null[2] > 0.0


@pytest.mark.parametrize(
    ("medium", "place", "words"),
    [
        ({"preset": "fog", "fluorescence": [_TINT]}, "", "expected either"),
        (
            {"fluorescence": [_TINT | {"absorption": {"blackbody": 3000}}]},
            ".fluorescence[0].absorption",
            "table",
        ),
        ({"fluorescence": [_TINT | {"emission": 1.0}]}, ".fluorescence[0].emission", "table"),
        (
            {"fluorescence": [_TINT | {"absorption": {"table": [[200, 1.0], [300, 1.0]]}}]},
            ".fluorescence",
            "360 to 830 nm",
        ),
        ({"fluorescence": [_TINT], "density": {"scale_height": 10.0}}, ".density", "fluoresces"),
    ],
)
def test_impossible_dyes_are_refused(
    document: dict[str, Any], blobs: BlobStore, medium: Any, place: str, words: str
) -> None:
    expect_problem(_dyed(document, **medium), blobs, f"$.media.dye{place}", words)


@pytest.mark.parametrize(("name", "value"), [("direction", "both"), ("sharing", 16)])
def test_dyes_change_only_photons_from_the_sensor(
    document: dict[str, Any], blobs: BlobStore, name: str, value: Any
) -> None:
    document["tracing"] = {name: value}
    expect_problem(_dyed(document, fluorescence=[_TINT]), blobs, f"$.tracing.{name}", "fluoresce")
