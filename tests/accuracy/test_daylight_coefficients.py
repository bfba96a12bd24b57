"""Daylight coefficients against quadrature, direct renders of the same light, and single hours of a year."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.local.annual import read_weather
from nocturne_client.local.daylight_rounds import DaylightScene, Rounds, Traced, daylight_scene, rounds
from nocturne_scene.daylight.coefficients import Layout, illuminances
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight.year_of_skies import skies_of
from nocturne_scene.validation.documents import diffuse, quad, surface

from tests.accuracy.agreement import student_bound
from tests.accuracy.tracing import trace
from tests.weather import epw

Document = dict[str, Any]
BATCHES = 32
PANE = {"type": "thin_pane", "index": 1.5}
# Of the opening in the wall z = 4, to the south: x and y.
LEFT, RIGHT, LOW, HIGH = 0.5, 3.5, 0.8, 2.6


def room(reflectance: float, points: list[list[float]], *more: Document, normal: Any = (0, 1, 0)) -> Document:
    """4 m x 4 m x 3 m, y up and north at -z, open in the south."""
    walls = [
        quad([0, 0, 0], [0, 0, 4], [4, 0, 0]),
        quad([0, 3, 0], [4, 0, 0], [0, 0, 4]),
        quad([0, 0, 0], [4, 0, 0], [0, 3, 0]),
        quad([0, 0, 0], [0, 3, 0], [0, 0, 4]),
        quad([4, 0, 0], [0, 0, 4], [0, 3, 0]),
        quad([0, 0, 4], [4, 0, 0], [0, LOW, 0]),
        quad([0, HIGH, 4], [4, 0, 0], [0, 3 - HIGH, 0]),
        quad([0, LOW, 4], [LEFT, 0, 0], [0, HIGH - LOW, 0]),
        quad([RIGHT, LOW, 4], [4 - RIGHT, 0, 0], [0, HIGH - LOW, 0]),
    ]
    meters = {"name": "points", "points": points, "normal": list(normal)}
    return {
        "nocturne": 1,
        "sensor": {"type": "meters", "instruments": [meters]},
        "environment": {"radiance": {"illuminant": "D65", "luminance": 1.0}},
        "surfaces": [*(surface(each, diffuse(reflectance)) for each in walls), *more],
    }


def read(document: Document, folder: Path) -> DaylightScene:
    path = folder / "room.json"
    path.write_text(json.dumps(document))
    return daylight_scene(path, {}, None)


def means(values: np.ndarray[Any, Any]) -> tuple[Any, Any]:
    """Over batches, and standard errors."""
    return values.mean(axis=0), values.std(axis=0, ddof=1) / BATCHES**0.5


def test_patches_through_an_opening_by_quadrature(tmp_path: Path) -> None:
    """A meter that looks at the opening of a black room: what each patch of an even sky brings, by sums over
    the opening."""
    scene = read(room(0.0, [[1.5, 1.2, 2.0]], normal=(0, 0, 1)), tmp_path)
    patches, samples = Patches(1), 256
    asked = Rounds(BATCHES, samples, 2, 5)
    traced = Traced(scene, scene.on_disk, tmp_path, patches, asked, lambda _: None)
    sums = traced.trace(0, samples)[0][:, 0] / samples
    assert not sums[:, 1].any()
    mean, error = means(sums[:, 0])
    x, y = np.meshgrid(
        *(low + (np.arange(800) + 0.5) / 800 * (high - low) for low, high in ((LEFT, RIGHT), (LOW, HIGH)))
    )
    to = np.stack([x - 1.5, y - 1.2, np.full_like(x, 2.0)], axis=-1)
    distance = np.linalg.norm(to, axis=-1)
    area = (RIGHT - LEFT) * (HIGH - LOW) / x.size
    brought = area * (to[..., 2] / distance) ** 2 / distance**2
    # East is +x, north -z.
    towards = np.stack([to[..., 0], -to[..., 2], to[..., 1]], axis=-1) / distance[..., None]
    truth = np.bincount(patches.numbers(towards).ravel(), brought.ravel(), patches.count)
    seen = truth > 0
    assert not mean[~seen].any()
    assert mean.sum() == pytest.approx(truth.sum(), rel=0.01)
    bound = student_bound(int(seen.sum()), BATCHES - 1)
    # Points of the sums may lie on the other side of a patch's edge.
    assert (np.abs(mean - truth)[seen] <= bound * error[seen] + 0.01 * truth.max()).all()


def test_patches_together_are_the_direct_render(tmp_path: Path) -> None:
    document = room(0.5, [[2, 0.8, 3], [1, 0.8, 1]], surface(quad([0, 0, 4.01], [4, 0, 0], [0, 3, 0]), PANE))
    scene = read(document, tmp_path)
    samples = 128
    traced = Traced(
        scene, scene.on_disk, tmp_path, Patches(2), Rounds(BATCHES, samples, 2, 5), lambda _: None
    )
    mean, error = means(traced.trace(0, samples)[0].sum(axis=(2, 3)) / samples)
    image = trace(document, tmp_path, (2, 1), 4096)
    direct, its_error = image.xyz[0, :, 1], image.y_stderr[0]
    assert (np.abs(mean - direct) <= student_bound(2, BATCHES - 1) * np.hypot(error, its_error)).all()


def test_hours_of_a_year_by_brute_force(tmp_path: Path) -> None:
    """Two clear hours and an overcast one, each rendered with its own sky and Sun."""
    document = room(0.5, [[1, 0.8, 1], [2, 0.8, 2]], surface(quad([0, 0, 4.01], [4, 0, 0], [0, 3, 0]), PANE))
    weather = tmp_path / "year.epw"
    weather.write_text(epw())
    year = read_weather(weather)
    layout = Layout(Patches(2), Patches(4))
    skies = skies_of(year, layout.sky, 0.0)
    *_, coefficients = rounds(read(document, tmp_path), layout, skies, Rounds(BATCHES, 128, 2, 5))
    lit = illuminances(coefficients, skies, layout).whole
    for hour in (24 * 78 + 12, 24 * 171 + 9, 24 * 80 + 10):
        when = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(days=float(year.julian_days[hour]) - 2440587.5)
        place = {"latitude": 48.8, "longitude": 9.2, "altitude": 250.0}
        document["environment"] = {
            "diffuse_horizontal": year.diffuse_horizontal[hour],
            "direct_normal": year.direct_normal[hour],
            "dew_point": year.dew_point[hour],
            "place": place,
            "time": when.isoformat(),
        }
        image = trace(document, tmp_path, (2, 1), 8192)
        mean, error = means(lit[:, :, int(np.flatnonzero(skies.hours == hour)[0])])
        direct, its_error = image.xyz[0, :, 1], image.y_stderr[0]
        allowed = student_bound(6, BATCHES - 1) * np.hypot(error, its_error)
        # Patches stand for the sky within them: up to 2 % in addition to chance.
        assert (np.abs(mean - direct) <= allowed + 0.02 * direct).all(), (hour, mean, error, direct)
