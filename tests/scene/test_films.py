"""Coatings and glazings as messages; mistakes are told with their places."""

from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.compile import spectra
from nocturne_scene.compile.films import bare_sheet
from nocturne_scene.errors import InputError
from nocturne_scene.spectra import indices
from nocturne_scene.validation.closed_forms import fresnel, plate
from nocturne_scene.validation.stacks import one_behind_other, unpolarised

from .conftest import Compile

QUARTER = {"index": "MgF2", "thickness_nm": 99.6}
SILVER = {"index": "Ag", "thickness_nm": 12}
CLEAR = {"front_reflectance": 0.083, "back_reflectance": 0.083, "transmittance": 0.899}
COATED = {"front_reflectance": 0.05, "back_reflectance": 0.11, "transmittance": 0.78}


def surface_of(document: dict[str, Any], compiled: Compile, kernel: Any) -> scene_pb2.CompiledScene:
    document["surfaces"][0] = {"shape": {"type": "box", "minimum": [0, 0, 0], "maximum": [1, 1, 1]}}
    document["surfaces"][0]["kernel"] = kernel
    document["environment"] = {"radiance": 1}
    return compiled(document)


def sides(scene: scene_pb2.CompiledScene) -> tuple[scene_pb2.Kernel, scene_pb2.Kernel]:
    surface = scene.surfaces[0]
    back = surface.back_kernel if surface.HasField("back_kernel") else surface.kernel
    return scene.kernels[surface.kernel], scene.kernels[back]


def test_a_coating_is_reversed_for_light_from_inside(document: dict[str, Any], compiled: Compile) -> None:
    glass = {"type": "dielectric", "index": 1.5168, "coating": [QUARTER, SILVER]}
    scene = surface_of(document, compiled, glass)
    front, back = (side.coated_dielectric for side in sides(scene))
    assert [layer.thickness_nm for layer in front.layers] == [99.6, 12]
    assert list(back.layers) == list(front.layers)[::-1]
    quarter, silver = front.layers
    at = np.array([550.0])
    n = spectra.evaluate(scene.spectra[quarter.n], at)
    assert n == pytest.approx([1.3786], abs=1e-4)  # M. J. Dodge 1984, its table at 0.55 um
    assert not spectra.evaluate(scene.spectra[quarter.k], at).any()
    assert spectra.evaluate(scene.spectra[silver.k], at) == pytest.approx(indices.metal("Ag").k(at), rel=1e-3)


def test_one_layer_is_the_same_from_both_sides(document: dict[str, Any], compiled: Compile) -> None:
    glass = {"type": "dielectric", "index": 1.5168, "coating": [QUARTER]}
    assert not surface_of(document, compiled, glass).surfaces[0].HasField("back_kernel")


def test_bare_surfaces_have_the_messages_of_old(document: dict[str, Any], compiled: Compile) -> None:
    """So that scenes without films keep their digests, and older workers trace them."""
    glass = {"type": "dielectric", "index": 1.5168, "coating": []}
    assert sides(surface_of(document, compiled, glass))[0].WhichOneof("model") == "dielectric"
    metal = {"type": "conductor", "index": "Al"}
    assert sides(surface_of(document, compiled, metal))[0].WhichOneof("model") == "conductor"
    metal["coating"] = [QUARTER]  # type: ignore[assignment]
    assert sides(surface_of(document, compiled, metal))[0].WhichOneof("model") == "coated_conductor"


def test_a_coated_body_may_be_masked_and_blended(document: dict[str, Any], compiled: Compile) -> None:
    glass = {"type": "dielectric", "index": 1.5168, "coating": [QUARTER, SILVER]}
    scene = surface_of(document, compiled, {"type": "mask", "kernel": glass, "opacity": 0.5})
    leaves = [
        scene.kernels[part.kernel].coated_dielectric.layers
        for side in sides(scene)
        for part in side.blend.parts
        if scene.kernels[part.kernel].WhichOneof("model") == "coated_dielectric"
    ]
    assert list(leaves[0]) == list(leaves[1])[::-1]


def test_a_glazing_is_turned_for_light_from_behind(document: dict[str, Any], compiled: Compile) -> None:
    panes = [COATED, {"index": 1.52, "front": [SILVER]}, {"film": [QUARTER]}]
    front, back = (
        side.glazing for side in sides(surface_of(document, compiled, {"type": "glazing", "panes": panes}))
    )
    assert [pane.WhichOneof("kind") for pane in front.panes] == ["measured", "sheet", "film"]
    assert (front.from_back, back.from_back) == (False, True)
    assert list(front.panes) == list(back.panes)
    same = {"type": "glazing", "panes": [CLEAR, CLEAR]}
    assert not surface_of(document, compiled, same).surfaces[0].HasField("back_kernel")


def test_a_bare_measured_pane_becomes_a_sheet(document: dict[str, Any], compiled: Compile) -> None:
    scene = surface_of(document, compiled, {"type": "glazing", "panes": [CLEAR]})
    sheet = sides(scene)[0].glazing.panes[0].sheet
    n, inside = (scene.spectra[each].values[0] for each in (sheet.index, sheet.transmittance))
    through, back = plate(n, 0.0, -np.log(inside))
    assert (through, back) == pytest.approx((0.899, 0.083), abs=1e-6)


@pytest.mark.parametrize(("n", "inside"), [(1.52, 1.0), (1.8, 0.5), (1.0, 0.3), (1.52, 1e-6)])
def test_a_sheet_is_found_by_its_shares(n: float, inside: float) -> None:
    face = fresnel(n, 0.0)
    through = (1 - face) ** 2 * inside / (1 - (face * inside) ** 2)
    found = bare_sheet(np.array([face * (1 + inside * through)]), np.array([through]))
    assert found[0] == pytest.approx([n], abs=1e-6)
    assert found[1] == pytest.approx([inside], rel=1e-5, abs=1e-9)


def test_an_opaque_pane_stays_opaque() -> None:
    index, inside = bare_sheet(np.array([0.0, 0.04, 1.0]), np.array([0.0, 0.0, 0.0]))
    assert index[:2] == pytest.approx([1.0, 1.5])
    assert np.all(np.isfinite(index))
    assert not inside.any()


def test_characteristic_matrices_have_the_textbooks_digits() -> None:
    """Macleod's quarter waves, and EN 410's double pane."""
    at = np.array([550.0])
    quarter, glass = [(1.38, 550 / (4 * 1.38))], 1.5168
    assert unpolarised(at, 0.0, quarter, glass)[0] == pytest.approx([0.0128354], abs=5e-8)
    high, low = (2.35, 550 / (4 * 2.35)), quarter[0]
    for pairs, known in ((1, 0.68386), (3, 0.95595), (5, 0.99466), (7, 0.99936)):
        found = unpolarised(at, 0.0, [high, low] * pairs + [high], glass)[0]
        assert found == pytest.approx([known], abs=1e-5)
    reflected, through = unpolarised(at, 50.0, [high, low], 1.52)
    assert reflected + through == pytest.approx([1.0], abs=1e-12)
    pane = (np.array([0.083]), np.array([0.083]), np.array([0.899]))
    assert one_behind_other(pane, pane)[2] == pytest.approx([0.814], abs=5e-4)


@pytest.mark.parametrize(
    ("kernel", "told"),
    [
        (
            {"type": "conductor", "index": "Al", "coating": [{"index": "MgF2", "thickness_nm": 0}]},
            ".coating[0].thickness_nm",
        ),
        (
            {"type": "conductor", "index": "Al", "coating": [{"index": "MgF", "thickness_nm": 9}]},
            '.coating[0].index: no index of refraction named "MgF"; expected one of "N-BK7"',
        ),
        (
            {"type": "dielectric", "index": 1.5, "coating": [{"index": 200.0, "thickness_nm": 9}]},
            ".coating[0].index: n or k is 200; expected at most 100 of a film's layer",
        ),
        (
            {"type": "dielectric", "index": 1.0, "roughness": 0.1, "coating": [QUARTER]},
            ".index: the body has the index of the air around it",
        ),
        (
            {"type": "dielectric", "index": 1.5, "coating": [QUARTER] * 65},
            ".coating",
        ),
        ({"type": "glazing", "panes": []}, ".panes"),
        ({"type": "glazing", "panes": [{"thickness": 4}]}, ".panes[0]: expected an object with one of"),
        ({"type": "glazing", "panes": [COATED | {"transmittance": 0.96}]}, ".panes[0].front_reflectance"),
        ({"type": "glazing", "panes": [CLEAR, CLEAR | {"transmittance": 1.5}]}, ".panes[1]"),
        (
            {
                "type": "glazing",
                "panes": [COATED | {"back_reflectance": {"table": [[400, 0.1], [700, 0.4]]}}],
            },
            ".panes[0].back_reflectance: reflectance and transmittance add up to 1.18 at 700 nm",
        ),
    ],
)
def test_mistakes_are_told_with_their_places(
    document: dict[str, Any], compiled: Compile, kernel: Any, told: str
) -> None:
    with pytest.raises(InputError) as caught:
        surface_of(document, compiled, kernel)
    assert f"$.surfaces[0].kernel{told}" in str(caught.value)


def test_panes_are_known_over_all_of_a_scene_s_wavelengths(
    document: dict[str, Any], compiled: Compile
) -> None:
    document["wavelengths"] = {"first": 900, "last": 1700}
    document["sensor"]["measures"] = "radiant"
    clear = {name: {"table": [[900, value], [1700, value]]} for name, value in CLEAR.items()}
    scene = surface_of(document, compiled, {"type": "glazing", "panes": [clear]})
    sheet = sides(scene)[0].glazing.panes[0].sheet
    n, inside = (np.array(scene.spectra[each].values) for each in (sheet.index, sheet.transmittance))
    through, back = plate(n.max(), 0.0, -np.log(inside.min()))
    assert (through, back) == pytest.approx((0.899, 0.083), abs=1e-6)
    bright = clear | {"transmittance": {"table": [[900, 0.8], [1700, 0.95]]}}
    with pytest.raises(InputError, match=r"add up to 1\.033 at 1700 nm"):
        surface_of(document, compiled, {"type": "glazing", "panes": [bright]})
