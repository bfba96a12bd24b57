"""Media in the document: their checks, and their messages."""

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.compile.tracing import NO_LIMIT
from nocturne_scene.document.read import check_document
from nocturne_scene.spectra.published import visible_wavelengths

from tests.scene.conftest import Compile, Document

BALL = {"type": "sphere", "centre": [0, 0, 0], "radius": 1}


def with_media(document: Document, **media: Any) -> Document:
    """The document with media; the first fills a ball, surface 3."""
    document["media"] = media
    document["surfaces"].append({"shape": BALL, "interior": {"media": [next(iter(media))]}})
    return document


def dropped(document: Document, blobs: BlobStore) -> list[str]:
    return compile_scene(check_document(document), blobs).dropped


def values(scene: scene_pb2.CompiledScene, index: int) -> list[float]:
    return list(scene.spectra[index].values)


def test_a_ball_of_fog_has_a_boundary_that_is_not_seen(document: Document, compiled: Compile) -> None:
    fog = {"absorption": 0.5, "scattering": {"table": [[400, 2], [500, 3]]}, "density": 0.25}
    scene = compiled(with_media(document, fog=fog))
    [medium], [interior], ball = scene.media, scene.interiors, scene.surfaces[3]
    assert values(scene, medium.absorption) == [0.5]
    assert values(scene, medium.scattering) == [2, 3]
    assert medium.constant == 0.25
    assert medium.phase.henyey_greenstein.g == 0
    assert not medium.HasField("temperature")
    assert (interior.index_matched, interior.priority, list(interior.media)) == (True, 0, [0])
    assert scene.kernels[ball.kernel].WhichOneof("model") == "null_kernel"
    assert ball.HasField("interior")
    assert ball.interior == 0


def test_a_scene_without_media_is_compiled_as_before(document: Document, compiled: Compile) -> None:
    scene = compiled(document)
    assert not scene.media
    assert not scene.interiors
    assert not scene.unbounded_interiors


def test_photons_have_no_limit_but_the_documents(document: Document, compiled: Compile) -> None:
    for scene in (document, with_media(document, fog={"scattering": 1})):
        assert compiled(scene).tracing.maximum_depth == NO_LIMIT == 0
        limited = scene | {"tracing": {"maximum_depth": 12}}
        assert compiled(limited).tracing.maximum_depth == 12


def test_photons_travel_together_but_forward_in_media(document: Document, compiled: Compile) -> None:
    document["sensor"] = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, 1], "height": 1}
    document["tracing"] = {"direction": "forward"}
    assert compiled(document).tracing.group == 4
    forward = with_media(document, fog={"scattering": 1})
    assert compiled(forward).tracing.group == 1
    forward["tracing"] = {}
    assert compiled(forward).tracing.group == 4


@pytest.mark.parametrize(
    ("phase", "message"),
    [
        (None, {"henyey_greenstein": {"g": 0.0}}),
        ({"type": "isotropic"}, {"henyey_greenstein": {"g": 0.0}}),
        ({"type": "henyey_greenstein", "g": -0.3}, {"henyey_greenstein": {"g": -0.3}}),
        (
            {"type": "double_henyey_greenstein", "first": 0.9, "second": -0.2, "weight": 0.7},
            {"double_henyey_greenstein": {"g_first": 0.9, "g_second": -0.2, "weight": 0.7}},
        ),
        ({"type": "rayleigh"}, {"rayleigh": {}}),
        (
            {"type": "tabulated", "cosines": [-1, 0.5, 1], "values": [[1, 2, 4]]},
            {"tabulated": {"wavelengths": [550.0], "cosines": [-1.0, 0.5, 1.0], "values": [1.0, 2.0, 4.0]}},
        ),
        (
            {
                "type": "tabulated",
                "cosines": [-1, 1],
                "wavelengths": [400, 700],
                "values": [[1, 2], [3, 4]],
            },
            {
                "tabulated": {
                    "wavelengths": [400.0, 700.0],
                    "cosines": [-1.0, 1.0],
                    "values": [1.0, 2.0, 3.0, 4.0],
                }
            },
        ),
    ],
)
def test_phase_functions(document: Document, compiled: Compile, phase: Any, message: dict[str, Any]) -> None:
    fog = {"scattering": 1} | ({} if phase is None else {"phase": phase})
    [medium] = compiled(with_media(document, fog=fog)).media
    kind = str(medium.phase.WhichOneof("shape"))
    assert [kind] == list(message)
    found, expected = getattr(medium.phase, kind), message[kind]
    assert {field.name for field, _ in found.ListFields()} <= expected.keys()
    for name, value in expected.items():
        assert (list(getattr(found, name)) if isinstance(value, list) else getattr(found, name)) == value


def test_depolarisation_is_a_spectrum(document: Document, compiled: Compile) -> None:
    phase = {"type": "rayleigh", "depolarisation": {"table": [[400, 0.03], [700, 0.02]]}}
    scene = compiled(with_media(document, air={"scattering": 1, "phase": phase}))
    index = scene.media[0].phase.rayleigh.depolarisation
    assert scene.media[0].phase.rayleigh.HasField("depolarisation")
    assert [at(scene, index, 400), at(scene, index, 700)] == pytest.approx([0.03, 0.02])


def test_densities_by_altitude(document: Document, compiled: Compile) -> None:
    document = with_media(
        document,
        air={"scattering": 3, "density": {"scale_height": 8000, "at_ground": 0.5}},
        haze={
            "scattering": 2,
            "density": {
                "layers": [[-1, 0], [0, 2], [10, 1]],
                "above": {"centre": [0, -6371e3, 0], "radius": 6371e3},
            },
        },
    )
    document["unbounded_media"] = ["haze"]
    scene = compiled(document)
    air, haze = scene.media
    # The message has no density at the ground: the coefficients take it.
    assert values(scene, air.scattering) == [1.5]
    assert air.altitude == scene_pb2.AltitudeDensity(
        base=scene_pb2.Vector(), up=scene_pb2.Vector(y=1), scale_height=8000
    )
    assert haze.altitude == scene_pb2.AltitudeDensity(
        base=scene_pb2.Vector(),
        up=scene_pb2.Vector(y=1),
        radius=6371e3,
        table=scene_pb2.AltitudeTable(altitudes=[-1, 0, 10], densities=[0, 2, 1]),
    )
    [everywhere] = scene.unbounded_interiors
    assert list(scene.interiors[everywhere].media) == [1]
    # So that every dielectric body keeps it out.
    assert scene.interiors[everywhere].priority == -1_000_000


def test_a_medium_in_glass(document: Document, compiled: Compile) -> None:
    glass = {"type": "dielectric", "index": 1.5, "priority": 3, "absorption": 0.1}
    document = with_media(document, milk={"scattering": 7})
    document["surfaces"][3]["kernel"] = glass
    document["surfaces"].append({"shape": BALL, "kernel": glass})
    scene = compiled(document)
    full, clear = scene.interiors
    assert (full.index_matched, full.priority, list(full.media)) == (False, 3, [0])
    assert values(scene, full.index) == [1.5]
    assert values(scene, full.absorption) == pytest.approx([0.1])
    assert not clear.media
    assert [surface.interior for surface in scene.surfaces[3:]] == [0, 1]


def test_what_only_absorbs_in_glass_is_the_glasses_own_absorption(
    document: Document, compiled: Compile
) -> None:
    document = with_media(document, dye={"absorption": {"table": [[400, 2], [500, 3]]}, "density": 0.5})
    document["surfaces"][3]["kernel"] = {"type": "dielectric", "index": 1.5}
    scene = compiled(document)
    assert not scene.media
    assert values(scene, scene.interiors[0].absorption) == [1, 1.5]


@pytest.mark.parametrize(
    "medium",
    [
        {"absorption": 1, "scattering": 1},
        {"absorption": 1, "density": {"scale_height": 1}},
    ],
)
def test_other_media_in_glass_stay_media(document: Document, compiled: Compile, medium: Document) -> None:
    document = with_media(document, milk=medium)
    document["surfaces"][3]["kernel"] = {"type": "dielectric", "index": 1.5}
    scene = compiled(document)
    assert list(scene.interiors[0].media) == [0]
    assert not scene.interiors[0].HasField("absorption")


def test_a_second_absorber_stays_a_medium(document: Document, compiled: Compile) -> None:
    document = with_media(document, dye={"absorption": 1}, ink={"absorption": 2})
    document["surfaces"][3] |= {
        "kernel": {"type": "dielectric", "index": 1.5},
        "interior": {"media": ["dye", "ink"]},
    }
    scene = compiled(document)
    assert values(scene, scene.interiors[0].absorption) == [1]
    assert [values(scene, medium.absorption) for medium in scene.media] == [[2]]


def test_equal_media_stay_apart_as_they_add_up(document: Document, compiled: Compile) -> None:
    document = with_media(document, one={"scattering": 1}, other={"scattering": 1})
    document["surfaces"][3]["interior"]["media"] = ["one", "other"]
    scene = compiled(document)
    assert len(scene.media) == 2
    assert list(scene.interiors[0].media) == [0, 1]


def test_a_medium_is_compiled_once(document: Document, compiled: Compile) -> None:
    document = with_media(document, fog={"scattering": 1})
    document["surfaces"].append({"shape": {**BALL, "radius": 2}, "interior": {"media": ["fog"]}})
    scene = compiled(document)
    assert len(scene.media) == len(scene.interiors) == 1


@pytest.mark.parametrize(
    ("medium", "reason"),
    [
        ({"scattering": 1, "density": 0}, "has no density"),
        ({"scattering": 0, "absorption": 0}, "neither absorbs nor scatters"),
        ({"scattering": {"table": [[900, 1], [950, 1]], "outside": "zero"}}, "neither absorbs nor scatters"),
    ],
)
def test_what_is_nothing_is_left_out_and_told(
    document: Document, blobs: BlobStore, compiled: Compile, medium: Document, reason: str
) -> None:
    document = with_media(document, fog=medium, spare={"scattering": 1})
    told = dropped(document, blobs)
    assert any(line.startswith("$.media.fog: ") and reason in line for line in told)
    assert "$.media.spare: nothing uses it" in told
    scene = compiled(document)
    assert not scene.media
    assert not scene.interiors
    assert not scene.surfaces[3].HasField("interior")


def test_a_scene_may_be_nothing_but_fog(document: Document, compiled: Compile) -> None:
    scene = {key: document[key] for key in ("nocturne", "sensor")}
    scene |= {"media": {"fog": {"scattering": 1}}, "unbounded_media": ["fog"], "environment": {"radiance": 1}}
    compiled_scene = compiled(scene)
    assert list(compiled_scene.unbounded_interiors) == [0]
    assert compiled_scene.tracing.weight_kernel > 0


coefficient = st.floats(0, 1e6, allow_subnormal=False, width=32)


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    absorption=coefficient,
    scattering=coefficient,
    density=st.floats(0, 1e3, width=32),
    priority=st.integers(-1_000_000, 1_000_000),
    g=st.floats(-0.999, 0.999),
)
def test_numbers_arrive_as_they_are_written(
    document: Document,
    compiled: Compile,
    absorption: float,
    scattering: float,
    density: float,
    priority: int,
    g: float,
) -> None:
    phase = {"type": "henyey_greenstein", "g": g}
    fog = {"absorption": absorption, "scattering": scattering, "density": density, "phase": phase}
    ball = {"shape": BALL, "interior": {"media": ["fog"], "priority": priority}}
    scene = compiled(document | {"media": {"fog": fog}, "surfaces": [*document["surfaces"], ball]})
    if density == 0 or absorption == scattering == 0:
        assert not scene.media
        return
    [medium], [interior] = scene.media, scene.interiors
    assert values(scene, medium.absorption) == [absorption]
    assert values(scene, medium.scattering) == [scattering]
    assert (medium.constant, medium.phase.henyey_greenstein.g, interior.priority) == (density, g, priority)


def at(scene: scene_pb2.CompiledScene, index: int, wavelength: float) -> float:
    return float(spectra.evaluate(scene.spectra[index], np.array([wavelength]))[0])


@pytest.mark.parametrize(
    ("name", "scattering", "absorption"),
    [
        ("marble", (2.19, 2.62, 3.00), (0.0021, 0.0041, 0.0071)),
        ("whole milk", (2.55, 3.21, 3.77), (0.0011, 0.0024, 0.014)),
        ("skin 1", (0.74, 0.88, 1.01), (0.032, 0.17, 0.48)),
    ],
)
def test_measured_media(
    document: Document,
    compiled: Compile,
    name: str,
    scattering: tuple[float, ...],
    absorption: tuple[float, ...],
) -> None:
    """Jensen et al. 2001, figure 5: red, green and blue, 1/mm."""
    scene = compiled(with_media(document, it={"preset": name, "density": 2}))
    [medium] = scene.media
    assert medium.constant == 2
    assert medium.phase.henyey_greenstein.g == 0
    for index, truth in ((medium.scattering, scattering), (medium.absorption, absorption)):
        found = [at(scene, index, wavelength) / 1e3 for wavelength in (611, 549, 464)]
        assert found == pytest.approx(truth)
        assert at(scene, index, 360) == pytest.approx(1e3 * truth[2])
        assert at(scene, index, 830) == pytest.approx(1e3 * truth[0])


def test_clean_air(document: Document, compiled: Compile) -> None:
    """At sea level: 2.5469e25 molecules per m3 times the cross-section, 4.510e-31 m2 at 550 nm."""
    scene = compiled(with_media(document, air={"preset": "air"}))
    [medium] = scene.media
    assert at(scene, medium.scattering, 550) == pytest.approx(2.546899e25 * 4.5104647e-31, rel=1e-6)
    assert spectra.is_black(scene.spectra[medium.absorption])
    ratio = spectra.evaluate(scene.spectra[medium.phase.rayleigh.depolarisation], visible_wavelengths())
    assert np.all((ratio > 0.027) & (ratio < 0.031))
