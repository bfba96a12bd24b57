"""Glare ratings of made-up images, against their formulas on paper and the published table of position
indices."""

import math

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.photometry.directions import Projection, directions_of
from nocturne_scene.photometry.glare import Glare, View, glare_of, position_index
from nocturne_scene.quantities import ILLUMINANCE, LUMINANCE

from tests.scene.eyes import FISHEYE, PANORAMA, Values, image_of, with_sources


def glare(projection: Projection, y: Values, view: View | None = None, error: float = 0.0) -> Glare:
    return glare_of(image_of(y, error), LUMINANCE, projection, view or View())


# CIE 117:1995, table 4.1, as transcribed in github.com/123VincentB/eulumdat-ugr (guth.py): its row
# for sources straight above the line of sight (T/R = 0), H/R and the position index.
_ABOVE = {
    0.3: 1.90,
    0.5: 2.86,
    0.7: 4.20,
    0.9: 6.00,
    1.0: 7.00,
    1.2: 9.25,
    1.4: 11.70,
    1.6: 14.70,
}


@pytest.mark.parametrize(("height", "index"), _ABOVE.items())
def test_position_indices_are_those_of_the_published_table(height: float, index: float) -> None:
    found = position_index(np.array(0.0), np.array(height), np.array(1.0))
    assert float(found) == pytest.approx(index, rel=0.05)


# Of the same table, T/R and H/R.
_BESIDE = {
    (0.3, 0.2): 1.60,
    (0.5, 0.5): 2.91,
    (1.0, 0.0): 2.11,
    (1.0, 1.0): 7.00,
    (1.3, 0.3): 3.70,
    (2.0, 0.5): 5.80,
    (2.0, 1.5): 12.85,
    (3.0, 0.0): 4.22,
    (3.0, 1.9): 16.00,
}


@pytest.mark.parametrize(("place", "index"), _BESIDE.items())
def test_position_indices_are_near_the_published_table(place: tuple[float, float], index: float) -> None:
    """Levin's formula is a fit, 12 % at most from Guth's plot."""
    found = position_index(np.array(place[0]), np.array(place[1]), np.array(1.0))
    assert float(found) == pytest.approx(index, rel=0.12)


def test_the_line_of_sight_has_position_index_1() -> None:
    found = position_index(np.zeros(2), np.array([1e-9, -1e-9]), np.ones(2))
    assert found == pytest.approx([1.0, 1.0])


def test_below_the_line_of_sight_the_index_is_that_of_iwata() -> None:
    """1 + 0.8 R / D up to 0.6, 1 + 1.2 R / D beyond."""
    found = position_index(np.array([0.3, 0.6]), np.array([-0.4, -0.8]), np.ones(2))
    assert found == pytest.approx([1.4, 2.2])


@pytest.mark.parametrize("projection", ["panorama", "equidistant", "equisolid"])
def test_solid_angles_add_up(projection: Projection) -> None:
    seen = directions_of(projection, *(PANORAMA if projection == "panorama" else FISHEYE))
    whole = 4 * math.pi if projection == "panorama" else 2 * math.pi
    assert float(seen.solid_angle.sum()) == pytest.approx(whole, rel=2e-3)
    forward = np.maximum(seen.direction[..., 2], 0.0)
    # An even half space of luminance 1 gives pi lx.
    assert float((seen.solid_angle * forward).sum()) == pytest.approx(math.pi, rel=2e-3)


@pytest.mark.parametrize("projection", ["panorama", "equidistant", "equisolid"])
def test_both_ratings_of_two_lamps_are_those_on_paper(projection: Projection) -> None:
    half, luminance, background = 4.0, 20_000.0, 60.0
    places = [(0.0, 30.0), (25.0, 15.0)]
    y = with_sources(projection, [(*place, half, luminance) for place in places], background)
    found = glare(projection, y, View(threshold=2000.0))
    solid_angle = 2 * math.pi * (1 - math.cos(math.radians(half)))
    total = illuminance = 0.0
    for azimuth, elevation in places:
        a, e = math.radians(azimuth), math.radians(elevation)
        direction = (math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a))
        p = float(position_index(*(np.array(each) for each in direction)))
        total += luminance**2 * solid_angle / p**2
        # A disc's projected solid angle: pi sin^2(half) cos(to its middle).
        illuminance += math.pi * math.sin(math.radians(half)) ** 2 * direction[2]
    behind = background * (math.pi - illuminance)
    vertical = luminance * illuminance + behind
    ugr = 8 * math.log10(0.25 / (behind / math.pi) * total)
    dgp = 5.87e-5 * vertical + 9.18e-2 * math.log10(1 + total / vertical**1.87) + 0.16
    assert len(found.sources) == 2
    assert found.vertical_illuminance == pytest.approx(vertical, rel=0.02)
    # A disc of pixels has its solid angle within some 4 % here: 8 log10(1.04) is 0.14.
    assert found.ugr == pytest.approx(ugr, abs=0.15)
    assert found.dgp == pytest.approx(dgp, abs=0.003)
    assert found.sources[0].solid_angle == pytest.approx(solid_angle, rel=0.05)
    places_found = sorted((source.azimuth_degrees, source.elevation_degrees) for source in found.sources)
    assert np.array(places_found) == pytest.approx(np.array(places), abs=0.5)
    assert not found.notes


def test_an_even_field_has_no_glare_but_light() -> None:
    """DGP without sources: 5.87e-5 pi L + 0.16."""
    found = glare("panorama", np.full(PANORAMA[::-1], 1000.0))
    assert found.dgp == pytest.approx(5.87e-5 * math.pi * 1000.0 + 0.16, rel=1e-4)
    assert math.isnan(found.ugr)
    assert found.sources == ()


def test_turning_the_eye_is_turning_the_room() -> None:
    straight = glare("panorama", with_sources("panorama", [(10, 20, 5, 9000.0)], 80.0))
    turned = with_sources("panorama", [(-80, 20, 5, 9000.0)], 80.0)
    found = glare("panorama", turned, View(azimuth_degrees=-90.0))
    assert found.ugr == pytest.approx(straight.ugr, abs=0.02)
    assert found.dgp == pytest.approx(straight.dgp, abs=1e-3)
    # Who looks at the lamp has it in the line of sight.
    at_it = glare("panorama", turned, View(azimuth_degrees=-80.0, elevation_degrees=20.0))
    assert at_it.sources[0].position_index == pytest.approx(1.0, abs=0.02)
    # Who looks away does not see it.
    assert glare("panorama", turned, View(azimuth_degrees=100.0)).sources == ()


def test_a_lamp_across_the_seam_is_one() -> None:
    y = with_sources("panorama", [(180, 10, 6, 9000.0)], 80.0)
    assert (y[:, 0] > 80).any()
    assert (y[:, -1] > 80).any()
    found = glare("panorama", y, View(azimuth_degrees=180.0))
    (source,) = found.sources
    assert source.azimuth_degrees == pytest.approx(0.0, abs=0.1)


def test_errors_are_those_of_images_that_are_drawn_again() -> None:
    y = with_sources("equidistant", [(0, 30, 6, 9000.0)], 100.0)[::6, ::6]
    rng = np.random.default_rng(8)
    told = glare("equidistant", y, error=0.2)
    drawn = [glare("equidistant", y * (1 + 0.2 * rng.standard_normal(y.shape))) for _ in range(300)]
    for name in ("ugr", "dgp", "vertical_illuminance"):
        spread = float(np.std([getattr(each, name) for each in drawn]))
        assert getattr(told, f"{name}_error") == pytest.approx(spread, rel=0.15)


def test_what_a_formula_is_not_for_is_said() -> None:
    dim = glare("panorama", with_sources("panorama", [(0, 30, 15, 3000.0)], 1.0))
    assert any("sources of 0.0003 to 0.1 sr; 1 of 1 are not" in note for note in dim.notes)
    narrow = glare_of(image_of(np.full(FISHEYE, 50.0)), LUMINANCE, "equidistant", View(), 120.0)
    assert any("whole half space" in note for note in narrow.notes)
    assert any("380 lx" in note for note in narrow.notes)


@pytest.mark.parametrize(
    ("field", "message"),
    [
        ({"quantity": ILLUMINANCE}, "glare is made of luminance in cd/m2, and this image is of illuminance"),
        ({"projection": "perspective"}, "expected panorama, equidistant, equisolid"),
        ({"view": View(threshold=0.0)}, "threshold above 0"),
        ({"projection": "equisolid", "field_degrees": 0.0}, "a fisheye sees more than 0"),
    ],
)
def test_other_images_are_refused(field: dict[str, object], message: str) -> None:
    asked: dict[str, object] = {"quantity": LUMINANCE, "projection": "panorama", "view": View(), **field}
    with pytest.raises(InputError, match=message):
        glare_of(image_of(np.ones((8, 16))), **asked)  # type: ignore[arg-type]
