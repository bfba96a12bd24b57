"""Whole bodies of glass: invisible in uniform light, n^2 times the radiance inside; scenes of any size."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import diffuse, furnace, measured_scene, white_tile

from tests.accuracy.agreement import compare, sidak_bound
from tests.accuracy.meters import Measurement
from tests.accuracy.scenes import cornell
from tests.accuracy.spectral_meters import NO_ROULETTE, Estimate, flat, scene
from tests.accuracy.tracing import Document, part_of, trace
from tests.system.images import differing_values

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_BOUND = sidak_bound(12)

_BALL = {"type": "sphere", "centre": [0, 0, 0], "radius": 1.0}
_BOX = {"type": "box", "minimum": [-0.9, -0.8, -0.7], "maximum": [0.7, 0.8, 0.9]}


def _camera(position: list[float], degrees: float) -> Document:
    return {
        "type": "pinhole",
        "position": position,
        "look_at": [0, 0, 0],
        "vertical_field_of_view_degrees": degrees,
    }


def _white_inside(shape: Document, roughness: float) -> list[Document]:
    """Clear glass around a ball that scatters everything."""
    glass = {"type": "dielectric", "index": 1.5, "roughness": roughness}
    white = {"type": "lambertian", "reflectance": 1.0}
    ball = {"type": "sphere", "centre": [0, 0, 0], "radius": 0.3}
    return [{"shape": shape, "kernel": glass}, {"shape": ball, "kernel": white}]


@pytest.mark.parametrize("shape", [_BALL, _BOX], ids=["ball", "box"])
@pytest.mark.parametrize("filled", [False, True], ids=["clear", "white inside"])
def test_glass_is_invisible_in_uniform_light(shape: Document, filled: bool, tmp_path: Path) -> None:
    """L / n^2 is conserved and nothing is absorbed: 1 everywhere from outside."""
    surfaces = _white_inside(shape, 0.0)[: 2 if filled else 1]
    document = scene(_camera([0.5, 1, 4], 35), surfaces, **NO_ROULETTE)
    image = flat(trace(document, tmp_path, 16, 512))
    Estimate.of(image).check(1.0, _BOUND, f"outside, {shape['type']}")
    if not filled:
        # Only the wavelength is left to chance.
        assert np.abs(image - 1.0).max() < 0.02


@pytest.mark.parametrize("shape", [_BALL, _BOX], ids=["ball", "box"])
@pytest.mark.parametrize("together", [1, 4])
def test_radiance_inside_is_n_squared(shape: Document, together: int, tmp_path: Path) -> None:
    """2.25, where the camera inside looks at what scatters; light bounces in there for long.

    Standard error: about 0.3 %.
    """
    camera = _camera([0.3, 0.2, 0.6], 20)
    document = scene(camera, _white_inside(shape, 0.0), photons_together=together)
    Estimate.of(flat(trace(document, tmp_path, 16, 256))).check(2.25, _BOUND, shape["type"])


def test_photons_caught_in_a_box_end(tmp_path: Path) -> None:
    """A tile that hardly covers anything gets 2.25 in the directions that leave a box of index 1.5 at a face.

    The others never end by themselves. Photons sent towards lights there went on until their last ray, and
    images reported them. The light that comes back to the tile is below 1 %, its reflectance.
    """
    normal, reflectance = [0.36, 0.48, 0.8], 0.01
    tile, meter = white_tile(([0.1, 0.2, 0.05], normal))
    document = measured_scene(meter, [*_white_inside(_BOX, 0.0)[:1], tile | {"kernel": diffuse(reflectance)}])
    document["environment"] = {"radiance": 1.0}
    measurement = Measurement(document, tmp_path, 16, 16)
    to = np.random.default_rng(0).normal(size=(1_000_000, 3))
    to /= np.linalg.norm(to, axis=1)[:, None]
    leaves = np.abs(to).max(axis=1) > np.sqrt(1.0 - 1.0 / 1.5**2)
    part = (np.abs(to @ normal) * leaves).mean() / 0.5
    measurement.by_pixels(64).check(reflectance * 2.25 * part, reflectance)
    assert measurement.statistics["truncated_paths"] == 0


def test_rough_glass_loses_only_what_its_model_loses(tmp_path: Path) -> None:
    """Facets of roughness 0.1 scatter once: a little light is lost between them, none is gained."""
    document = scene(_camera([0.3, 0.2, 0.6], 20), _white_inside(_BALL, 0.1))
    found = Estimate.of(flat(trace(document, tmp_path, 16, 256)))
    assert 2.25 * 0.95 < found.mean < 2.25 + 3 * found.error


def test_index_1_in_a_scene(tmp_path: Path) -> None:
    """A ball of index 1 in the Cornell box changes nothing but random numbers."""
    plain = {"sequence": "independent", "seed": 1}
    with_ball = cornell(plain | {"seed": 2})
    ball = {"type": "sphere", "centre": [0.2, 0.35, 0.2], "radius": 0.12}
    with_ball["surfaces"].append({"shape": ball, "kernel": {"type": "dielectric", "index": 1.0}})
    images = [trace(document, tmp_path, 32, part_of(512)) for document in (cornell(plain), with_ball)]
    compare(*images).check_mean_and_tiles()


def _scaled(value: Any, factor: float) -> Any:
    """A document in another unit of length: powers of 2 change no digit."""
    lengths = {"position", "look_at", "corner", "edge_u", "edge_v", "vertices", "centre", "radius"}
    lengths |= {"minimum", "maximum", "translate", "height", "lens_radius", "focus_distance"}
    if isinstance(value, list):
        return [_scaled(each, factor) for each in value]
    if not isinstance(value, dict):
        return value
    return {
        key: (np.array(each) * factor).tolist() if key in lengths else _scaled(each, factor)
        for key, each in value.items()
    }


@pytest.mark.parametrize("power", [-20, -10, 10, 30])
def test_scenes_of_any_size(power: int, tmp_path: Path) -> None:
    """No length is built in, so the image is the same in each bit, from a box of half a micrometre to one as
    large as the Sun. (Shapes below 1e-7 m are refused.)
    """
    small = trace(_scaled(cornell({}), 2.0**power), tmp_path, 16, 64)
    reference = trace(cornell({}), tmp_path, 16, 64)
    differing = differing_values(small, reference)
    assert differing == {}


def test_the_smallest_scene(tmp_path: Path) -> None:
    """A furnace of 1e-7 m, the smallest quads that are allowed; at 1e-9 m it was 7 % too dark."""
    document = _scaled(furnace(0.5, 1.0), 1e-7)
    Estimate.of(flat(trace(document, tmp_path, 16, 256))).check(2.0, _BOUND, "smallest")


def test_instances_of_instances(tmp_path: Path) -> None:
    """A furnace through four nested scales from 1e-6 to 1e6, whose product is 1: still L / (1 - albedo)."""
    document = furnace(0.5, 1.0)
    groups: dict[str, Any] = {"0": document.pop("surfaces")}
    for level, scale in enumerate((1e6, 1e-3, 1e-6), start=1):
        groups[str(level)] = [{"group": str(level - 1), "scale": scale}]
    document |= {"groups": groups, "surfaces": [], "instances": [{"group": "3", "scale": 1e3}]}
    Estimate.of(flat(trace(document, tmp_path, 16, 256))).check(2.0, _BOUND, "nested")
