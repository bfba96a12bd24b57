"""Lines of any width have the colour of the line, and wavelengths are drawn so that they are found."""

from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.document.spectra import LineSpectrum
from nocturne_scene.spectra import lines as line_spectra
from nocturne_scene.spectra import published
from numpy.typing import NDArray

from tests.scene.conftest import Compile, Document

Floats = NDArray[np.float64]
WAVELENGTHS = published.visible_wavelengths()

LINES = {
    # Doublet of sodium, two lines of mercury, helium-neon laser: x, y, Y per unit of radiant power (lm over
    # K_m) from the CIE 1931 table each nm, linear in between.
    "Na": ([(588.995, 2 / 3), (589.592, 1 / 3)], 0.57039795, 0.42896562, 0.7667963),
    "Hg546": ([(546.074, 1.0)], 0.27349433, 0.71758787, 0.98433851),
    "Hg436": ([(435.833, 1.0)], 0.16652004, 0.0088972812, 0.017812411),
    "HeNe": ([(632.8, 1.0)], 0.71147236, 0.28848329, 0.23724544),
}


def cmf() -> Floats:
    return published.observer("CIE 1931 2 degree")


def line(nm: float, power: float = 1.0, width: float = 0.1) -> scene_pb2.Line:
    return scene_pb2.Line(centre_nm=nm, power=power, width_nm=width)


def written(lines: list[tuple[float, float]], width: float) -> dict[str, Any]:
    return {"lines": [{"nm": nm, "power": power, "width": width} for nm, power in lines]}


def lit_by(document: Document, *radiances: Any, **sensor: Any) -> Document:
    """The scene with a lamp of each radiance."""
    lamp = document["surfaces"][1]
    lamps = [lamp | {"luminaire": {"radiance": radiance}} for radiance in radiances]
    return document | {
        "surfaces": [document["surfaces"][0], *lamps],
        "sensor": document["sensor"] | sensor,
    }


def density_of(scene: scene_pb2.CompiledScene) -> tuple[Floats, Floats]:
    return np.array(scene.sensor.wavelength_knots), np.array(scene.sensor.wavelength_density)


def share(knots: Floats, density: Floats, low: float, high: float) -> float:
    inside = (knots >= low) & (knots <= high)
    return float(np.trapezoid(density[inside], knots[inside]))


# A wider line averages the observer's curve, which bends; bounds are three to ten times the observed errors.
@pytest.mark.parametrize(("width", "error"), [(0.01, 1e-6), (0.1, 1e-5), (1.0, 2e-4)])
@pytest.mark.parametrize("name", LINES)
def test_lines_of_any_width_have_the_colour_of_the_line(
    name: str, width: float, error: float, document: Document, compiled: Compile
) -> None:
    lines, x, y, luminous = LINES[name]
    scene = compiled(lit_by(document, written(lines, width)))
    message = scene.spectra[scene.luminaires[0].radiance.spectrum]
    assert (list(message.values), len(message.lines)) == ([0.0], len(lines))
    xyz = spectra.integral(message, cmf())
    assert xyz[1] == pytest.approx(luminous, abs=error)
    assert xyz[:2] / xyz.sum() == pytest.approx((x, y), abs=error)


def test_the_integral_against_a_curve_is_exact() -> None:
    rng = np.random.default_rng(1)
    curve = rng.random(len(WAVELENGTHS))
    lines = [line(rng.uniform(350, 840), rng.random(), rng.uniform(0.01, 9)) for _ in range(30)]
    fine = np.linspace(360, 830, 47_000 * 40 + 1)
    product = line_spectra.values_at(lines, fine) * np.interp(fine, WAVELENGTHS, curve)
    assert line_spectra.integrals(lines, curve) == pytest.approx(np.trapezoid(product, fine), rel=1e-4)


def test_a_line_keeps_power_and_centre_wherever_it_lies() -> None:
    rng = np.random.default_rng(2)
    curves = np.stack([np.ones(len(WAVELENGTHS)), WAVELENGTHS], axis=1)
    for centre, width in zip(rng.uniform(400, 800, 50), 10 ** rng.uniform(-2, 1.5, 50), strict=True):
        power, first = line_spectra.integrals([line(centre, 2.5, width)], curves)
        assert (power, first / power) == pytest.approx((2.5, centre), rel=1e-9)
        on_grid = line_spectra.projected([line(centre, 2.5, width)])
        assert on_grid @ curves == pytest.approx((2.5, 2.5 * centre), rel=1e-9)


def test_lines_closer_than_their_width_add_up() -> None:
    close = [line(500.0, 1.0, 0.5), line(500.2, 3.0, 0.5)]
    at = np.array([499.4, 499.6, 500.0, 500.1, 500.2, 500.5, 500.8])
    # Heights 2 and 6 nm-1, each falling to zero over half a nanometre.
    expected = np.array([0, 0.4, 2, 1.6, 1.2, 0, 0]) + np.array([0, 0, 3.6, 4.8, 6, 2.4, 0])
    assert line_spectra.values_at(close, at) == pytest.approx(expected)
    both = line_spectra.integrals(close, cmf())
    assert both == pytest.approx(sum(line_spectra.integrals([one], cmf()) for one in close))


def test_lines_scale_to_a_luminance() -> None:
    spectrum = LineSpectrum.model_validate(written(LINES["Na"][0], 0.02) | {"luminance": 300})
    message = spectra.radiance(spectrum)
    assert spectra.luminance(message) == pytest.approx(300, rel=1e-12)
    assert message.lines[0].power == pytest.approx(2 * message.lines[1].power)
    assert spectra.luminance(spectra.scaled_to_luminance(message, 7.0)) == pytest.approx(7)


def test_a_disc_keeps_the_lines_of_its_irradiance(document: Document, compiled: Compile) -> None:
    irradiance = written(LINES["HeNe"][0], 0.01)
    scene = compiled(
        document
        | {"distant": [{"direction": [0, 1, 0], "irradiance": irradiance, "angular_diameter_degrees": 2}]}
    )
    [found] = scene.spectra[scene.distant_discs[0].radiance].lines
    assert found.power * np.pi * np.sin(np.radians(1)) ** 2 == pytest.approx(1)
    assert scene.sensor.wavelength_knots


def test_lines_that_nobody_sees_are_left_out_and_told(document: Document, blobs: BlobStore) -> None:
    mercury = {"lines": [{"nm": 253.7, "power": 1}, {"nm": 546.074, "power": 1}]}
    inline = lit_by(document, mercury)
    named = lit_by(document, "Hg", "Hg") | {"spectra": document["spectra"] | {"Hg": mercury}}
    outside = "lines[0]: lies outside of 360 to 830 nm"
    for scene, place in ((inline, "$.surfaces[1].luminaire.radiance"), (named, "$.spectra.Hg")):
        output = compile_scene(check_document(scene), blobs)
        assert [told for told in output.dropped if "outside" in told] == [f"{place}.{outside}"]
        message = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
        assert [len(spectrum.lines) for spectrum in message.spectra if spectrum.lines] == [1]


def test_wavelengths_find_narrow_lines(document: Document, compiled: Compile) -> None:
    scene = compiled(lit_by(document, written([(546.074, 1.0)], 0.01)))
    knots, density = density_of(scene)
    assert np.trapezoid(density, knots) == pytest.approx(1)
    # Half of all wavelengths fall on a line that is a 47,000th of the range.
    assert share(knots, density, 546.06, 546.09) == pytest.approx(0.5, abs=0.01)
    assert len(knots) == 471 + 3
    response = cmf().sum(axis=1)
    alone = np.interp(knots, WAVELENGTHS, response / np.trapezoid(response, WAVELENGTHS))
    assert np.all(density >= 0.5 * alone * (1 - 1e-6))


def test_each_spectrum_with_lines_has_an_equal_part(document: Document, compiled: Compile) -> None:
    faint, strong = written([(435.833, 1e-6)], 0.01), written(LINES["Na"][0], 0.1)
    scene = compiled(lit_by(document, faint, strong, strong, {"blackbody": 3000}))
    knots, density = density_of(scene)
    assert share(knots, density, 435.82, 435.85) == pytest.approx(0.25, abs=0.01)
    assert share(knots, density, 588, 590) == pytest.approx(0.25, abs=0.03)
    doublet = share(knots, density, 588.8, 589.2), share(knots, density, 589.4, 589.8)
    # Two to one, but for the response that falls and the half that knows no lines.
    assert doublet[0] / doublet[1] == pytest.approx(2, abs=0.1)


def test_further_responses_count(document: Document, compiled: Compile) -> None:
    infrared = {"responses": {"infrared": {"table": [[800, 1], [820, 1]]}}}
    knots, density = density_of(
        compiled(lit_by(document, written([(546.074, 1.0), (810.0, 1.0)], 0.01), **infrared))
    )
    assert share(knots, density, 809.9, 810.1) > 0.1


@pytest.mark.parametrize(
    ("radiance", "sensor"),
    [
        ({"blackbody": 3000}, {}),
        (written([(546.074, 1.0)], 5.0), {}),
        (written([(546.074, 1.0)], 5.0), {"wavelengths": "uniform"}),
    ],
)
def test_without_narrow_lines_the_sensor_has_no_density(
    radiance: Any, sensor: Any, document: Document, compiled: Compile
) -> None:
    scene = compiled(lit_by(document, radiance, **sensor))
    assert not scene.sensor.wavelength_knots
    assert not scene.sensor.wavelength_density


def test_uniform_wavelengths_find_narrow_lines(document: Document, compiled: Compile) -> None:
    """Half of them, and the others are as likely everywhere."""
    radiance = written([(546.074, 1.0)], 0.1)
    scene = compiled(lit_by(document, radiance, wavelengths="uniform"))
    knots, density = density_of(scene)
    base = density[(knots < 545.9) | (knots > 546.3)]
    assert base == pytest.approx(0.5 / 470.0, rel=1e-5)
    assert np.trapezoid(density - 0.5 / 470.0, knots) == pytest.approx(0.5, rel=1e-4)


def test_of_too_many_lines_the_strongest_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(line_spectra, "DENSITY_LINES", 3)
    lines = [line(500.0 + i, power) for i, power in enumerate([5, 1, 4, 2, 3])]
    knots, _ = line_spectra.wavelength_density(np.ones(len(WAVELENGTHS)), [lines])
    assert {500.1, 502.1, 504.1} <= set(knots.round(6))
    assert not {501.1, 503.1} & set(knots.round(6))


def test_a_line_as_response_keeps_its_area() -> None:
    curve = spectra.response_curve(LineSpectrum.model_validate(written([(546.074, 2.0)], 0.01)))
    assert curve.sum() == pytest.approx(2)
    assert np.count_nonzero(curve) == 2
