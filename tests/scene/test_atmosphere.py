"""The atmosphere: spheres, densities by altitude, and optical depths against published ones."""

from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError
from nocturne_scene.media import presets as media_presets
from nocturne_scene.media import rayleigh
from nocturne_scene.spectra.published import _colour

from tests.scene.conftest import Compile, Document

# Bodhaine et al. 1999, equation 30: optical depth of clean air at sea level, 1013.25 hPa.
OPTICAL_DEPTHS = {
    360: 0.55975784,
    400: 0.36021342,
    450: 0.22110602,
    500: 0.14335333,
    550: 0.097065238,
    600: 0.068087139,
    650: 0.049183507,
    700: 0.036420908,
    780: 0.023511769,
    830: 0.018296489,
}

RADIUS = 6_371_000.0


def with_atmosphere(document: Document, **atmosphere: Any) -> Document:
    scene = {key: document[key] for key in ("nocturne", "sensor")}
    scene["environment"] = {"radiance": 1}
    return scene | {"atmosphere": atmosphere}


def density(medium: scene_pb2.Medium, altitudes: np.ndarray) -> np.ndarray:
    """As scene.proto says."""
    profile = medium.altitude
    if profile.WhichOneof("profile") == "scale_height":
        return np.asarray(np.exp(-altitudes / profile.scale_height))
    table = profile.table
    return np.asarray(np.interp(altitudes, table.altitudes, table.densities, left=0.0, right=0.0))


def vertical_depth(
    scene: scene_pb2.CompiledScene, medium: scene_pb2.Medium, wavelengths: np.ndarray, top: float
) -> np.ndarray:
    """Gauss-Legendre on each of 200 pieces from the ground up."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = np.linspace(0.0, top, 201)
    half = 0.5 * (edges[1:] - edges[:-1])
    altitudes = (0.5 * (edges[1:] + edges[:-1]))[:, None] + half[:, None] * nodes
    column = float(np.sum(half[:, None] * weights * density(medium, altitudes)))
    coefficients = sum(
        spectra.evaluate(scene.spectra[index], wavelengths)
        for index in (medium.absorption, medium.scattering)
    )
    return np.asarray(column * coefficients)


@pytest.mark.parametrize("scale_height", [8449.5, 6000.0, 20_000.0])
def test_straight_up_air_has_the_published_optical_depth(
    document: Document, compiled: Compile, scale_height: float
) -> None:
    scene = compiled(with_atmosphere(document, air={"scale_height": scale_height}))
    [air] = scene.media
    wavelengths = np.array(list(OPTICAL_DEPTHS), dtype=np.float64)
    found = vertical_depth(scene, air, wavelengths, 100_000.0)
    assert found == pytest.approx(np.array(list(OPTICAL_DEPTHS.values())), rel=1e-6)


def test_optical_depth_goes_with_pressure(document: Document, compiled: Compile) -> None:
    scene = compiled(with_atmosphere(document, air={"pressure": 68_000}))
    found = vertical_depth(scene, scene.media[0], np.array([550.0]), 100_000.0)
    assert found[0] == pytest.approx(OPTICAL_DEPTHS[550] * 680 / 1013.25, rel=1e-6)


def test_air_scatters_as_a_second_method_says() -> None:
    """The whole procedure of Bodhaine et al. with the index of refraction of air (Peck and Reeder), and
    King's factor, both in colour-science. Their fit is good to 0.01 % at 250 to 850 nm."""
    phenomena = _colour().phenomena
    wavelengths = np.array([360.0, 450.0, 550.0, 650.0, 830.0])
    sigma = phenomena.scattering_cross_section(wavelengths * 1e-7, 360.0, 288.15)  # cm, ppm; cm2
    assert rayleigh.cross_section(wavelengths) == pytest.approx(sigma * 1e-4, rel=3e-4)
    king = phenomena.rayleigh.F_air_Bodhaine1999(wavelengths * 1e-3, 360.0)
    ratio = rayleigh.depolarisation(wavelengths)
    assert (6 + 3 * ratio) / (6 - 7 * ratio) == pytest.approx(king, rel=1e-6)


def test_ozone(document: Document, compiled: Compile) -> None:
    """300 Dobson units are 8.06e22 molecules above 1 m2."""
    scene = compiled(with_atmosphere(document, air=None, ozone={"dobson_units": 300}))
    [ozone] = scene.media
    assert spectra.is_black(scene.spectra[ozone.scattering])
    found = vertical_depth(scene, ozone, np.array([365.0, 605.0]), 100_000.0)
    assert found == pytest.approx(300 * 2.686780111e20 * np.array([1.18e-27, 5.019e-25]), rel=1e-6)
    assert density(ozone, np.array([9e3, 10e3, 17.5e3, 25e3, 40e3, 41e3])).tolist() == [0, 0, 0.5, 1, 0, 0]


def test_ozone_cross_sections_agree_with_a_laser() -> None:
    """3.37e-25 m2 at 632.8 nm (S. M. Anderson and K. Mauersberger, Geophysical Research Letters 19, 1992).

    At room temperature, on which the Chappuis band hardly depends; the table has means over 10 nm.
    """
    assert media_presets.ozone_cross_section(np.array([632.8]))[0] == pytest.approx(3.37e-25, rel=0.02)


def test_aerosol(document: Document, compiled: Compile) -> None:
    document = with_atmosphere(document, aerosol={"medium": "haze", "optical_depth": 0.2})
    phase = {"type": "henyey_greenstein", "g": 0.7}
    document["media"] = {
        "haze": {"scattering": {"table": [[500, 4], [600, 2]]}, "absorption": 1, "phase": phase, "density": 7}
    }
    scene = compiled(document)
    _, aerosol = scene.media
    assert aerosol.altitude.scale_height == 1200
    assert aerosol.phase.henyey_greenstein.g == 0.7
    found = vertical_depth(scene, aerosol, np.array([550.0]), 100_000.0)
    assert found == pytest.approx(0.2, rel=1e-6)
    # Of 4 parts at 550 nm, 3 are scattered; at 600 nm 2 of 3.
    ratio = spectra.evaluate(scene.spectra[aerosol.scattering], np.array([550.0, 600.0]))
    absorbed = spectra.evaluate(scene.spectra[aerosol.absorption], np.array([550.0, 600.0]))
    assert ratio / absorbed == pytest.approx([3, 2])
    assert [list(interior.media) for interior in scene.interiors] == [[0, 1]]


def test_the_spheres_have_their_places_to_a_millimetre(document: Document, compiled: Compile) -> None:
    """float64 from here to the tracer: in float32 steps would be half a metre."""
    document["sensor"]["position"] = [0, 0, 0]
    scene = compiled(with_atmosphere(document, altitude=1.234567, up=[0, 0, 2], ground_reflectance=0.3))
    shell, ground = scene.surfaces
    for sphere in (shell.sphere, ground.sphere):
        assert (sphere.centre.x, sphere.centre.y) == (0, 0)
        assert -sphere.centre.z - RADIUS == pytest.approx(1.234567, abs=1e-8)
    assert (shell.sphere.radius, ground.sphere.radius) == (RADIUS + 100_000, RADIUS)
    [air] = scene.media
    base = air.altitude.base
    assert (base.x, base.y, base.z) == pytest.approx((0, 0, -1.234567), abs=1e-8)
    assert air.altitude.radius == RADIUS
    assert air.altitude.up == scene_pb2.Vector(z=1)
    assert scene.kernels[shell.kernel].WhichOneof("model") == "null_kernel"
    lambertian = scene.kernels[ground.kernel].lambertian
    assert list(scene.spectra[lambertian.reflectance.spectrum].values) == pytest.approx([0.3])
    [interior] = scene.interiors
    assert (interior.index_matched, interior.priority) == (True, -1_000_000)
    assert shell.HasField("interior")
    assert not ground.HasField("interior")


def test_luminaires_keep_their_surfaces(document: Document, compiled: Compile) -> None:
    """The planet's spheres come last."""
    document["atmosphere"] = {}
    scene = compiled(document)
    assert [luminaire.surface for luminaire in scene.luminaires] == [1]
    assert len(scene.surfaces) == 5


def test_a_sensor_below_the_ground_is_refused(document: Document, compiled: Compile) -> None:
    """Air grows denser downwards: photons that started there wandered until they were given up."""
    document["sensor"]["position"] = [0.3, -0.8, 2.0]
    with pytest.raises(InputError) as caught:
        compiled(with_atmosphere(document, altitude=0.79))
    [problem] = caught.value.problems
    assert problem.place == "$.sensor.position"
    assert "below the ground" in problem.message
    compiled(with_atmosphere(document, altitude=0.81))


@pytest.mark.parametrize(
    ("atmosphere", "place", "words"),
    [
        ({"up": [0, 0, 0]}, "$.atmosphere.up", "no length"),
        ({"altitude": -7e6}, "$.atmosphere.altitude", "deeper"),
        ({"air": None}, "$.atmosphere", "neither air nor ozone nor aerosol"),
        ({"thickness": 0}, "$.atmosphere.thickness", "at least"),
        ({"ozone": {}, "thickness": 30_000}, "$.atmosphere.ozone", "reaches up to 40000 m"),
        ({"ground_reflectance": 2.0}, "$.atmosphere.ground_reflectance", "[0, 1]"),
        ({"air": {"pressure": 0}}, "$.atmosphere.air.pressure", "more than 0"),
        ({"aerosol": {"medium": "x", "optical_depth": 1}}, "$.atmosphere.aerosol.medium", "no medium"),
    ],
)
def test_a_mistake_is_told_with_its_place(
    document: Document, blobs: BlobStore, atmosphere: Document, place: str, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        compile_scene(check_document(with_atmosphere(document, **atmosphere)), blobs)
    [problem] = caught.value.problems
    assert problem.place == place
    assert words in problem.message
