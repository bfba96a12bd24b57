"""Glare of images that tell their luminaires: by the part of each pixel that these fill, however dim they
are."""

import math

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.photometry.directions import directions_of
from nocturne_scene.photometry.glare import Glare, View, glare_of, position_index
from nocturne_scene.quantities import LUMINANCE

from tests.scene.eyes import Values, image_of

FILM = (192, 96)
FINER = 16
"""Directions on each side of a pixel."""
Disc = tuple[float, float, float]
"""Azimuth, elevation and half angle, degrees."""


def parts_of(discs: list[Disc], film: tuple[int, int] = FILM) -> Values:
    """Of each pixel, the part of its directions that discs fill."""
    width, height = film
    direction = directions_of("panorama", width * FINER, height * FINER).direction
    inside = np.zeros(direction.shape[:2])
    for azimuth, elevation, half in discs:
        a, e = np.deg2rad([azimuth, elevation])
        middle = np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)])
        inside[direction @ middle > np.cos(np.deg2rad(half))] = 1.0
    parts: Values = inside.reshape(height, FINER, width, FINER).mean(axis=(1, 3))
    return parts


def seen(part: Values, luminance: float, background: float | Values) -> Values:
    """Luminances of pixels that luminaires fill in part."""
    return part * luminance + (1.0 - part) * background


def rated(y: Values, part: Values | None, view: View | None = None, error: float = 0.0) -> Glare:
    return glare_of(image_of(y, error), LUMINANCE, "panorama", view or View(), emission=part)


def on_paper(discs: list[Disc], luminance: float, background: float) -> float:
    """CIE 117:1995, equation 4.1, of discs before an even background."""
    total = 0.0
    for azimuth, elevation, half in discs:
        a, e = math.radians(azimuth), math.radians(elevation)
        direction = (math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a))
        index = float(position_index(*(np.array(each) for each in direction)))
        total += luminance**2 * 2 * math.pi * (1 - math.cos(math.radians(half))) / index**2
    # Discs take their part of the half space from the background.
    hidden = sum(
        math.sin(math.radians(half)) ** 2 * math.cos(math.radians(e)) * math.cos(math.radians(a))
        for a, e, half in discs
    )
    return 8 * math.log10(0.25 / (background * (1 - hidden)) * total)


TWO: list[Disc] = [(0.0, 20.0, 4.0), (25.0, 12.0, 2.5)]


@pytest.mark.parametrize("luminance", [300.0, 1500.0, 20_000.0])
def test_a_rating_is_that_on_paper_however_dim_and_small(luminance: float) -> None:
    """Pixels of 1.9 degrees: the smaller disc has six, and most of both are edges."""
    part = parts_of(TWO)
    found = rated(seen(part, luminance, 40.0), part)
    assert len(found.sources) == 2
    assert found.ugr == pytest.approx(on_paper(TWO, luminance, 40.0), abs=0.03)
    assert [each.luminance for each in found.sources] == pytest.approx([luminance] * 2, rel=1e-3)
    hidden = np.sum(part * directions_of("panorama", *FILM).solid_angle)
    assert sum(each.solid_angle for each in found.sources) == pytest.approx(float(hidden))
    # By whole pixels from a threshold on it is lower.
    whole = rated(seen(part, luminance, 40.0), None, View(threshold=100.0))
    assert whole.ugr < on_paper(TWO, luminance, 40.0) - 0.5


def test_edges_show_the_background_that_is_near_them() -> None:
    """A lamp on the edge between a wall and a window that is brighter than the lamp."""
    part = parts_of([(0.0, 0.0, 6.0)])
    columns = np.arange(FILM[0])[None, :]
    background = np.broadcast_to(np.where(columns < FILM[0] / 2, 50.0, 5000.0), part.shape)
    (source,) = rated(seen(part, 1000.0, background), part).sources
    assert source.luminance == pytest.approx(1000.0, rel=0.02)


def test_a_luminaire_across_the_seam_is_one() -> None:
    part = parts_of([(180.0, 10.0, 5.0)])
    assert part[:, 0].any()
    assert part[:, -1].any()
    (source,) = rated(seen(part, 500.0, 20.0), part, View(azimuth_degrees=180.0)).sources
    assert source.azimuth_degrees == pytest.approx(0.0, abs=0.1)
    assert source.luminance == pytest.approx(500.0, rel=1e-3)


def test_errors_are_those_of_images_that_are_drawn_again() -> None:
    part = parts_of(TWO)
    y = seen(part, 1500.0, 400.0)
    rng = np.random.default_rng(8)
    told = rated(y, part, error=0.1)
    drawn = [rated(y * (1 + 0.1 * rng.standard_normal(y.shape)), part).ugr for _ in range(400)]
    assert told.ugr_error == pytest.approx(float(np.std(drawn)), rel=0.1)


def test_dgp_goes_by_luminance_as_before() -> None:
    part = parts_of(TWO)
    y = seen(part, 9000.0, 400.0)
    found, before = rated(y, part), rated(y, None)
    assert (found.dgp, found.dgp_error, found.dgp_sources) == (
        before.dgp,
        before.dgp_error,
        before.dgp_sources,
    )
    assert found.sources != before.sources


def test_a_threshold_is_for_both_ratings() -> None:
    part = parts_of(TWO)
    y = seen(part, 1500.0, 40.0)
    found = rated(y, part, View(threshold=300.0))
    assert found.ugr == rated(y, None, View(threshold=300.0)).ugr
    assert not any("layer" in note for note in found.notes)


def test_an_image_without_the_layer_goes_by_luminance_and_says_so() -> None:
    found = rated(seen(parts_of(TWO), 9000.0, 40.0), None)
    assert len(found.sources) == 2
    assert any(
        "no layer emission: UGR's sources are pixels of 2000 cd/m2 and more" in note for note in found.notes
    )


def test_no_rating_without_a_luminaire_in_sight() -> None:
    part = parts_of(TWO)
    away = rated(seen(part, 9000.0, 40.0), part, View(azimuth_degrees=180.0))
    assert math.isnan(away.ugr)
    assert away.sources == ()
    assert any(
        "UGR is not known: no luminaire is in sight; turn the eye, or give a threshold" in n
        for n in away.notes
    )
    dark = rated(seen(part, 100.0, 40.0), part, View(threshold=150.0))
    assert any("UGR is not known: nothing has 150 cd/m2 or more" in note for note in dark.notes)
    alone = rated(seen(part, 100.0, 0.0), part)
    assert any("UGR is not known: there is no light but that of its sources" in note for note in alone.notes)


def test_a_source_of_few_pixels_is_told_with_a_film_that_would_do() -> None:
    discs: list[Disc] = [(0.0, 20.0, 4.0), (10.0, 0.0, 1.0)]
    part = parts_of(discs)
    (note,) = [each for each in rated(seen(part, 800.0, 40.0), part).notes if "pixels" in each]
    assert note.startswith("UGR may be wrong by more than 0.2: 1 of 2 sources have fewer than 9 pixels")
    width, height = map(int, note.split("a film of ")[1].removesuffix(" would do").split(" x "))
    assert (width, height) == (640, 320)
    larger = parts_of(discs, (width, height))
    assert not any("pixels" in each for each in rated(seen(larger, 800.0, 40.0), larger).notes)
    # One that brings nothing is not worth a larger film.
    weak = np.where(np.arange(FILM[1])[:, None] > FILM[1] * 0.45, 20.0, 8000.0)
    assert not any("pixels" in each for each in rated(seen(part, 1.0, 0.0) * weak + 1.0, part).notes)


def test_what_is_beyond_the_published_table_is_told() -> None:
    """A lamp nearly above the eye: straight above the line of sight, the table ends at 62 degrees."""
    discs: list[Disc] = [(0.0, 20.0, 4.0), (0.0, 75.0, 20.0)]
    part = parts_of(discs)
    found = rated(seen(part, 1000.0, 40.0), part)
    assert found.sources[1].elevation_degrees > 62.2
    (note,) = [each for each in found.notes if "beyond the table" in each]
    alone = 8 * math.log10(0.25 / found.background_luminance * found.sources[0].brings)
    assert note.endswith(f"without them UGR is {alone:.1f}")
    within = parts_of([(0.0, 20.0, 4.0), (0.0, 60.0, 6.0)])
    assert not any("beyond the table" in note for note in rated(seen(within, 1000.0, 40.0), within).notes)


@pytest.mark.parametrize("part", [1.5, -0.1, math.nan])
def test_a_layer_that_holds_no_parts_is_refused(part: float) -> None:
    with pytest.raises(InputError, match="parts of pixels, from 0 to 1, in the layer emission"):
        rated(np.ones((8, 16)), np.full((8, 16), part))
