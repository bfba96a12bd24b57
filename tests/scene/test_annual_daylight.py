"""Weather files, patches of the sky, and figures of a year with their intervals."""

import math
from typing import Any

import numpy as np
import pytest
from nocturne_scene.daylight import metrics
from nocturne_scene.daylight.coefficients import (
    Coefficients,
    Illuminances,
    Layout,
    hours_of_sun,
    illuminances,
    with_blinds,
)
from nocturne_scene.daylight.metrics import Counting, Estimate
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight.solar_position import sun_at
from nocturne_scene.daylight.weather_files import BadWeatherFileError, WeatherYear, read_epw
from nocturne_scene.daylight.year_of_skies import YearOfSkies, skies_of

from tests.weather import epw

Values = np.ndarray[Any, np.dtype[np.float64]]


@pytest.fixture(scope="module")
def year() -> WeatherYear:
    return read_epw(epw())


def test_a_weather_file_is_read(year: WeatherYear) -> None:
    assert (year.name, year.zone) == ("Testing, NOW", 1.0)
    assert (year.place.latitude, year.place.longitude, year.place.altitude) == (48.8, 9.2, 250.0)
    assert len(year.hour) == 8760
    assert (year.month[0], year.day[0], year.hour[0]) == (1, 1, 0.5)
    assert (year.month[-1], year.day[-1], year.hour[-1]) == (12, 31, 23.5)
    # Midnight of 2001-01-01 at +1 h is 23:00 of the day before, Julian day 2451910.4583.
    assert year.julian_days[0] == pytest.approx(2451910.5 - 1 / 24 + 0.5 / 24, abs=1e-6)


@pytest.mark.parametrize(
    ("line", "column", "text", "words"),
    [
        (0, 0, "PLACE", "line 1: expected LOCATION"),
        (0, 6, "91", "line 1, column 7: expected a number from -90 to 90, found '91'"),
        (20, 14, "bright", "line 21, column 15: expected a number from 0 to 1500, found 'bright'"),
        (20, 15, "9999", "line 21, column 16: the irradiance is missing"),
        (20, 15, "-3", "line 21, column 16: expected a number from 0"),
        (8 + 24 * 58, 2, "30", "line 1401, column 3: there is no day 30 in month 2"),
    ],
)
def test_what_is_wrong_in_a_weather_file_is_told(line: int, column: int, text: str, words: str) -> None:
    lines = [each.split(",") for each in epw().splitlines()]
    lines[line][column] = text
    with pytest.raises(BadWeatherFileError, match="^" + words.replace("(", "[(]")):
        read_epw("\n".join(",".join(each) for each in lines))


def test_a_weather_file_of_half_a_year_is_refused() -> None:
    with pytest.raises(BadWeatherFileError, match="line 4388: 4380 hours; expected 8760"):
        read_epw("\n".join(epw().splitlines()[: 8 + 4380]))


@pytest.mark.parametrize(("divisions", "count"), [(1, 145), (2, 577), (4, 2305)])
def test_patches_of_the_sky(divisions: int, count: int) -> None:
    """Tregenza 1987 and Reinhart: how many there are; together they are the half-sphere."""
    patches = Patches(divisions)
    assert patches.count == count + 1
    assert patches.solid_angles[1:].sum() == pytest.approx(2 * math.pi)
    assert (patches.numbers(patches.points) == np.arange(1, count + 1)[:, None]).all()
    assert patches.numbers(np.array([0.0, 0.0, 1.0])) == count
    # Tregenza's are alike in size: the largest is a sixth above the mean.
    if divisions == 1:
        assert patches.solid_angles[1:].max() / patches.solid_angles[1:].mean() < 1.2


def test_skies_of_a_year_have_the_light_of_their_hours(year: WeatherYear) -> None:
    patches = Patches(1)
    skies = skies_of(year, patches, 0.2)
    assert (skies.hours == np.flatnonzero(year.diffuse_horizontal > 0)).all()
    cosines = patches.solid_angles[1:] * patches.points[..., 2].mean(axis=1)
    level = skies.luminances[:, 1:] @ cosines
    efficacy = level / year.diffuse_horizontal[skies.hours]
    # Daylight has 90 to 160 lm/W.
    assert efficacy.min() > 90
    assert efficacy.max() < 170
    sun = sun_at(year.julian_days[skies.hours], year.place)
    beam = skies.sun_illuminance * np.maximum(np.cos(np.radians(sun.zenith)), 0)
    assert skies.luminances[:, 0] == pytest.approx(0.2 / np.pi * (level + beam))


def open_field(layout: Layout, skies: YearOfSkies) -> Coefficients:
    """Of a meter that looks up under the open sky, in 32 equal batches of 2 samples."""
    patches, suns = layout.sky, skies.sun_towards[skies.sunny]
    cosines = np.zeros(patches.count)
    cosines[1:] = patches.solid_angles[1:] * patches.points[..., 2].mean(axis=1)
    straight = np.tile(2 * cosines, (32, 1, 1))
    of_suns = np.tile(np.maximum(suns[:, 2], 0.0), (32, 1, 1))
    return Coefficients(straight, np.zeros((32, 1, len(layout.sunny(skies)))), of_suns, np.ones((32, 1)), 2)


def test_an_open_field_has_all_the_light(year: WeatherYear) -> None:
    patches = Patches(1)
    skies = skies_of(year, patches, 0.2)
    layout = Layout(patches, Patches(4))
    lit = illuminances(open_field(layout, skies), skies, layout)
    expected = skies.luminances[:, 0] * np.pi / 0.2
    assert lit.whole[0, 0] == pytest.approx(expected)
    counting = Counting(np.ones(len(skies.hours), dtype=bool), 8760)
    found = metrics.replicates(lit, counting.figures())
    day = metrics.jackknife(found["DA"])
    assert day.value[0] == pytest.approx(np.count_nonzero(expected >= 300) / 8760)
    assert day.error[0] == 0
    parts = sum(found[name] for name in found if name.startswith("UDI"))
    assert parts == pytest.approx(1)
    # Below the limit are also the hours without light: the night.
    assert found["UDI below"][0, 0] >= 1 - len(skies.hours) / 8760
    assert found["lux hours of the year"][0, 0] == pytest.approx(expected.sum())
    sunny = np.count_nonzero(skies.sun_illuminance * skies.sun_towards[:, 2] > 1000)
    assert found["sun hours"][0, 0] == sunny > 250


def test_the_jackknife_of_a_mean_is_its_standard_error() -> None:
    """On the average over many points, as groups are few."""
    values = np.random.default_rng(1).normal(5, 1, (32, 400, 1))
    lit = Illuminances(values, np.zeros_like(values))
    counting = Counting(np.ones(1, dtype=bool), 1)
    found = metrics.jackknife(metrics.replicates(lit, counting.figures())["mean illuminance"])
    assert found.value == pytest.approx(values.mean(axis=0)[:, 0])
    assert np.mean(found.error**2) == pytest.approx(1 / 32, rel=0.1)


def test_the_bias_of_noise_is_taken_out() -> None:
    """Hours evenly between 0 and 600 lx, each seen with its own skewed noise: a twentieth too few would have
    300 lx, as most hours look darker than they are."""
    random = np.random.default_rng(3)
    true = np.linspace(0, 600, 4000)
    counting = Counting(np.ones(4000, dtype=bool), 4000)
    noise = random.gamma(0.2, 5.0, (32, 8, 4000))
    seen = 150 + (true - 150) * noise
    lit = Illuminances(np.maximum(seen, 0.0), np.zeros_like(seen))
    right = np.mean(true >= 300)
    values = metrics.replicates(lit, {"DA": counting.figures()["DA"]})["DA"].mean(axis=1)
    plain, corrected = values[0], metrics.jackknife(values).value
    assert abs(corrected - right) < 0.5 * abs(plain - right)


def test_points_that_chance_decides_make_the_interval() -> None:
    """Two of four points are sure to pass, and two do so with one half: 2, 3 or 4 with 1/4, 1/2, 1/4."""
    figure = Estimate(np.array([0.9, 0.8, 0.5, 0.5]), np.array([0.0, 0.01, 0.02, 0.02]), 7)
    share = metrics.share_of_points(figure, 0.5)
    assert (share.low, share.high) == (0.5, 1.0)
    assert share.at_least(0.5) == pytest.approx(1)
    assert share.at_least(0.75) == pytest.approx(0.75)
    assert share.at_least(1.0) == pytest.approx(0.25)
    nothing = metrics.share_of_points(Estimate(np.array([0.2, 0.3]), np.zeros(2), 7), 0.5)
    assert (nothing.value, nothing.low, nothing.high, nothing.at_least(0.55)) == (0, 0, 0, 0)


def test_intervals_of_a_threshold_hold() -> None:
    """Hours whose light is known, seen by 32 batches with an error of 30 % each: the share of hours with
    300 lx or more is in its interval in 95 of 100 repetitions, within what chance makes of 200 (0.1 % to
    each side)."""
    random = np.random.default_rng(7)
    true = np.exp(random.normal(math.log(330), 0.5, 2000))
    counting = Counting(np.ones(2000, dtype=bool), 2000)
    held = 0
    for _ in range(200):
        # One point's error is alike in all hours, as its photons are the same.
        seen = true * (1 + 0.3 * random.normal(size=(32, 1, 1)))
        lit = Illuminances(seen, np.zeros_like(seen))
        day = metrics.jackknife(metrics.replicates(lit, {"DA": counting.figures()["DA"]})["DA"])
        low, high = day.interval()
        held += bool(low[0] <= np.mean(true >= 300) <= high[0])
    assert held >= 179


def test_provision_of_daylight_is_of_half_the_year() -> None:
    """EN 17037: half of 4380 hours, at any time of the day, with 300 lx and with 100 lx. Hours that count for
    nothing else count here."""
    lux = np.full((1, 2, 4000), 50.0)
    lux[0, 0, :2190] = 300.0
    lux[0, 1, :2189] = 300.0
    lux[0, 1, 2189] = 100.0
    counting = Counting(np.zeros(4000, dtype=bool), 3650)
    figures = {name: counting.figures()[name] for name in metrics.PROVISION}
    one = Illuminances(lux[0], np.zeros_like(lux[0]))
    target, least = (figures[f"EN 17037 {name}"](one) for name in ("target", "minimum"))
    assert target == pytest.approx([0.5, 2189 / 4380])
    assert least == pytest.approx([0.5, 0.5])
    assert [each >= metrics.PROVISION_HOURS for each in target] == [True, False]


def test_glare_of_an_eye_by_its_illuminance() -> None:
    """Wienold 2007: DGPs = 6.22e-5 Ev + 0.184, so 0.35, 0.40 and 0.45 are 2669, 3473 and 4277 lx."""
    lux = np.array([2660.0, 2680.0, 3460.0, 3480.0, 4270.0, 4280.0])
    lit = Illuminances(np.tile(lux, (1, 1, 1)), np.zeros((1, 1, 6)))
    figures = Counting(np.ones(6, dtype=bool), 6).eye_figures()
    found = [figures[f"DGPs above {limit}"](lit)[0, 0] * 6 for limit in ("0.35", "0.40", "0.45")]
    assert found == pytest.approx([5, 3, 1])
    assert figures["Sun in sight"](lit)[0, 0] == 0


def test_blinds_close_where_the_sun_comes_in(year: WeatherYear) -> None:
    """In an open field more than 2 % of the points have 1000 lx of Sun as soon as it gives as much."""
    layout = Layout(Patches(1), Patches(1))
    skies = skies_of(year, layout.sky, 0.2)
    field = open_field(layout, skies)
    closed = hours_of_sun(field, skies)
    level = skies.sun_illuminance * np.maximum(skies.sun_towards[:, 2], 0.0)
    assert (closed == (level > 1000.0)).all()
    assert 0 < np.count_nonzero(closed) < len(closed)
    opened = illuminances(field, skies, layout)
    dark = Illuminances(np.zeros_like(opened.whole), np.zeros_like(opened.sun))
    both = with_blinds(opened, dark, closed)
    assert not both.whole[..., closed].any()
    assert (both.whole[..., ~closed] == opened.whole[..., ~closed]).all()
    assert both.sun is opened.sun


def test_a_correction_is_known_no_better_than_by_its_size() -> None:
    """The square of a mean of 32 numbers is too high by their variance over 32. All but a group of 4 have
    that bias over 28: the jackknife takes it out, and keeps it as a part of the error."""
    values = np.random.default_rng(2).normal(0, 1, (32, 400))
    left_out = [
        values.mean(axis=0),
        *(np.delete(values, g, axis=0).mean(axis=0) for g in metrics.groups_of(32)),
    ]
    found = metrics.jackknife(np.stack(left_out)[..., None] ** 2)
    assert abs(found.value.mean()) < 3 * found.value.std() / 20
    corrections = found.value[:, 0] - left_out[0] ** 2
    assert corrections.mean() == pytest.approx(-1 / 32, rel=0.1)
    assert (found.error[:, 0] >= np.abs(corrections)).all()
