"""Scenes of Mitsuba 3's own tests against its own spectral reference images.

False alarms: for the pixels far below 0.01 a scene, for the sums 0.018 (tiles 0.01, means of three channels
0.008). Seeds are fixed, so a test passes always or never. Expected differences and their reasons are also in
tests/mitsuba/README.md.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.compare.agreement import Difference, Estimate, compare
from nocturne_scene.errors import InputError

from tests.mitsuba.renders import FOLDER, Batches, Reference, import_test

pytestmark = [
    pytest.mark.references,
    pytest.mark.skipif(not FOLDER.is_dir(), reason=f"needs Mitsuba's test scenes in {FOLDER}"),
]

BATCHES, SAMPLES = 12, 64
# Films of more pixels than 48 x 48 need fewer samples of each.
PIXELS = 48 * 48

_COAT = "what Mitsuba's rough coat of alpha 1 loses depends on the angle, and here it does not"
_SKY = "the sky's texels are interpolated there and constant here; it is seen nearly without noise"
_TILES = "the spectra that stand for the same RGB are not quite the same; the means agree"
_CORNERS = "between vertices Mitsuba interpolates coefficients of spectra, this RGB: 0.1 %"
_SKYLIGHT = "0.2 to 0.4 %: the sky's picture, not the medium; with an even sky both agree"
_FIT = "0.07 % in Z: the spectra that stand for the same RGB are not quite the same"

# name: (why pixels differ, why sums differ), empty if they agree.
SCENES = {
    "bsdf_spheres/test_constant_path": ("", ""),
    "bsdf_spheres/test_envmap_path": ("", _SKY),
    "bsdf_spheres/test_arealight_path": ("", ""),
    "bsdf_spheres/test_textured_diffuse_path": ("", _TILES),
    "bsdf_spheres/test_roughplastic_linear_path": (_COAT, _COAT),
    "mesh_attributes/test_mesh_attributes_1_face_direct": ("", _FIT),
    "mesh_attributes/test_mesh_attributes_3_vertex_direct": ("", _CORNERS),
    "orthographic_sensor/test_orthographic_path": ("", ""),
    "participating_media/test_surf_area_light_volpath": ("", ""),
    "participating_media/test_homo_area_light_volpath": ("", ""),
    "participating_media/test_homo_null_envmap_volpath": ("", ""),
    "participating_media/test_homo_spectral_sigmat_volpathmis": ("", _SKYLIGHT),
    "participating_media/test_hetero_sigmat_volpath": ("", _SKYLIGHT),
}

# Their sums differ by about their noise: by some random numbers they agree.
NEAR = {
    "mesh_attributes/test_mesh_attributes_1_face_direct",
    "participating_media/test_hetero_sigmat_volpath",
}

# Scenes that have unsupported parts, with the importer's messages.
REFUSED = {
    "various_shapes/test_various_shapes_path": 'no support for the shape "sdfgrid"',
}


@dataclass(frozen=True)
class Rendered:
    """A scene and its reference."""

    guarded: Difference
    plain: Difference


_rendered: dict[str, Rendered] = {}


def rendered(name: str, folder: Path) -> Rendered:
    """Each scene is rendered once."""
    if name not in _rendered:
        scene = import_test(name, folder / "scene")
        film = scene.film
        samples = max(8, SAMPLES * PIXELS // max(PIXELS, film.width * film.height))
        image = Batches(scene, folder / "compiled", BATCHES, samples).render()
        reference = Reference.of(name)
        guarded = reference.guard(image, BATCHES * samples)
        found = Rendered(compare(guarded, reference.estimate), compare(image, reference.estimate))
        _rendered[name] = found
        print(f"{name}: {told(found)}")  # noqa: T201 - figures for tests/mitsuba/README.md
    return _rendered[name]


def told(found: Rendered) -> str:
    """Figures of one scene."""
    assert found.guarded.verdict is not None
    verdict = found.plain.verdict
    assert verdict is not None
    ratio = ", ".join(f"{each - 1:+.2%}" for each in found.plain.ratio)
    z = ", ".join(f"{each:+.1f}" for each in verdict.mean_z)
    share = found.guarded.verdict.share_explained
    return f"{share:.2%} of pixels, tiles {verdict.largest_tile:.2g}, means {ratio} (z {z})"


def expected(column: int) -> list[Any]:
    """All scenes; those that are known to differ must, unless by little more than their noise."""

    def marks(name: str, why: str) -> Any:
        return pytest.mark.xfail(reason=why, strict=name not in NEAR) if why else ()

    return [pytest.param(name, marks=marks(name, why[column])) for name, why in SCENES.items()]


@pytest.mark.parametrize("name", expected(0))
def test_pixels_agree(name: str, tmp_path: Path) -> None:
    found = rendered(name, tmp_path)
    assert found.guarded.verdict is not None
    assert found.guarded.verdict.pixels_agree, told(found)


@pytest.mark.parametrize("name", expected(1))
def test_tiles_and_means_agree(name: str, tmp_path: Path) -> None:
    found = rendered(name, tmp_path)
    assert found.plain.verdict is not None
    assert found.plain.verdict.sums_agree, told(found)


@pytest.mark.parametrize(("name", "said"), REFUSED.items())
def test_what_has_no_equal_is_refused_by_name(name: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as raised:
        import_test(name, tmp_path / "scene")
    assert all(said in str(problem) for problem in raised.value.problems)


def test_the_test_can_fail() -> None:
    """The reference with 2 % more light, as noisy as a render of 768 samples."""
    reference = Reference.of("bsdf_spheres/test_constant_path")
    one = reference.one_sample
    assert one.variance is not None
    variance = one.variance / 768
    noise = np.sqrt(variance) * np.random.default_rng(1).standard_normal(variance.shape)
    right = compare(Estimate(one.mean + noise, variance), reference.estimate).verdict
    wrong = compare(Estimate(1.02 * one.mean + noise, variance), reference.estimate).verdict
    assert right is not None
    assert right.pixels_agree
    assert right.sums_agree
    assert wrong is not None
    assert not wrong.sums_agree
