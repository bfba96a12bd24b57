"""Error bars on scenes with an answer on paper: 95 % intervals of X, Z, a response, u' and v' hold it.

Every pixel of a furnace has the same truth, so an image is as many trials as it has pixels or regions. With
independent samples (Sobol's are more even than their errors say) a rate from m of these is known to
sqrt(0.95 0.05 / m). Bounds are four of that, which a rate exceeds once in 16,000 by chance; seeds are fixed.
"""

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import compile_to
from nocturne_scene.compare.images import read_picture
from nocturne_scene.uncertainty import CONFIDENCE, ImageMoments, read_region
from nocturne_scene.validation.documents import diffuse, furnace, measured_scene, quad, sphere, surface

from tests.accuracy.tracing import IN_FULL, Document, run, run_seeds, write

pytestmark = pytest.mark.system

Values = npt.NDArray[np.float64]

_EDGE = 64 if IN_FULL else 32
_SAMPLES = 256
_RADIANCE = 2.0
_ALBEDO = 0.5
_RESPONSE = {"table": [[400, 0.0], [500, 1.0], [600, 0.0]]}

SKEW = 0.01
"""What intervals of 256 samples may hold less than 95 %: light that comes after k walls has a skewness, and
the narrowest response most of it (Cochran, "Sampling Techniques", 1977, 2.15)."""


def traced(document: Document, folder: Path) -> tuple[ImageMoments, Values]:
    """The image's moments, and the integrals of what X, Y, Z and the response weigh light by."""
    compiled = compile_to(write(document, folder), folder, _EDGE, _EDGE, _SAMPLES)
    run(compiled, folder)
    sensor = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes()).sensor
    picture = read_picture(folder / "image.exr")
    assert picture.names == ("X", "Y", "Z", "blue")
    assert picture.moments is not None
    blue = sensor.further_responses[0].values
    curves = (sensor.response_x, sensor.response_y, sensor.response_z, blue)
    integrals = [np.trapezoid(curve, dx=sensor.response_step_nm) for curve in curves]
    return picture.moments, np.array(integrals)


def coloured_furnace(sharing: int) -> Document:
    document = furnace(_ALBEDO, _RADIANCE)
    document["tracing"] = {"sequence": "independent", "seed": 3, "direction": "adjoint", "sharing": sharing}
    document["sensor"]["responses"] = {"blue": _RESPONSE}
    return document


def held(image: ImageMoments, truth: Values, edge: int) -> Values:
    """How often the intervals of regions with such an edge hold the truth: X, Y, Z, blue, u', v'."""
    whole = truth[0] + 15.0 * truth[1] + 3.0 * truth[2]
    true = np.array([*truth, 4.0 * truth[0] / whole, 9.0 * truth[1] / whole])
    found = []
    for y in range(0, _EDGE, edge):
        for x in range(0, _EDGE, edge):
            chosen = np.zeros((_EDGE, _EDGE), dtype=np.bool_)
            chosen[y : y + edge, x : x + edge] = True
            reading = read_region(image, chosen)
            assert reading is not None
            off = np.abs(np.array([*reading.mean, *reading.chromaticity]) - true)
            found.append(off <= CONFIDENCE * np.array([*reading.error, *reading.chromaticity_error]))
    rates: Values = np.mean(found, axis=0)
    return rates


@pytest.fixture(scope="module")
def image_and_truth(tmp_path_factory: pytest.TempPathFactory) -> tuple[ImageMoments, Values]:
    return _furnace(tmp_path_factory, 1)


@pytest.fixture(scope="module")
def shared_image_and_truth(tmp_path_factory: pytest.TempPathFactory) -> tuple[ImageMoments, Values]:
    return _furnace(tmp_path_factory, 16)


def _furnace(paths: pytest.TempPathFactory, sharing: int) -> tuple[ImageMoments, Values]:
    image, integrals = traced(coloured_furnace(sharing), paths.mktemp("furnace"))
    return image, _RADIANCE / (1.0 - _ALBEDO) * integrals


@pytest.mark.parametrize("edge", [1, 2, 4, 8] if IN_FULL else [2, 4])
def test_intervals_of_a_furnace_hold_its_radiance(
    edge: int, image_and_truth: tuple[ImageMoments, Values]
) -> None:
    rates = held(*image_and_truth, edge)
    slack = 4.0 * math.sqrt(0.95 * 0.05) / (_EDGE // edge)
    assert (rates >= 0.95 - SKEW - slack).all(), rates
    assert (rates <= 0.975 + slack).all(), rates


@pytest.mark.parametrize("edge", [1, 2, 4, 8] if IN_FULL else [4])
def test_intervals_hold_it_where_pixels_share(
    edge: int, shared_image_and_truth: tuple[ImageMoments, Values]
) -> None:
    """Wavelengths are common to blocks. The formula is cautious, so no interval is too wide to pass."""
    rates = held(*shared_image_and_truth, edge)
    assert (rates >= 0.95 - SKEW - 4.0 * math.sqrt(0.95 * 0.05) / (_EDGE // edge)).all(), rates


_SEEDS = 40
_FILM = 16
_MANY = 1024
"""Samples of a pixel. With 64, a pixel has so few photons of the caustic that its mean is far from normal."""


def _caustic() -> Document:
    """A floor next to a ball of metal outside of the picture: forward photons bring the light that it
    mirrors."""
    camera = {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "up": [0, 1, 0],
        "vertical_field_of_view_degrees": 20.0,
    }
    surfaces = [
        surface(quad([-3, -3, 0], [6, 0, 0], [0, 6, 0]), diffuse(0.6)),
        {"shape": sphere([1.6, 0.0, 0.7], 0.6), "kernel": {"type": "conductor", "index": "Au"}},
        surface(quad([-2.3, -0.3, 3], [0, 0.6, 0], [0.6, 0, 0]), diffuse(0.0), 20.0),
    ]
    return measured_scene(camera, surfaces, direction="both", sequence="independent", sharing=1)


@pytest.fixture(scope="module")
def images_by_both(tmp_path_factory: pytest.TempPathFactory) -> list[ImageMoments]:
    folder = tmp_path_factory.mktemp("both")
    compiled = compile_to(write(_caustic(), folder), folder, _FILM, _FILM, _MANY)
    run_seeds(compiled, folder, _SEEDS)
    found = [read_picture(folder / f"{seed}.exr").moments for seed in range(1, _SEEDS + 1)]
    return [each for each in found if each is not None]


@pytest.mark.skipif(not IN_FULL, reason="half a minute, in `make accuracy`")
@pytest.mark.parametrize("edge", [4, 8, 16])
def test_intervals_hold_it_by_both_directions(edge: int, images_by_both: list[ImageMoments]) -> None:
    """X, Y, Z, u' and v' of each region, against the mean of all other seeds; and how images scatter.

    A photon from a luminaire lights pixels far apart, so only seeds are independent trials. A standard
    deviation from n of them is known to a part of 1 / sqrt(2 (n - 1)).
    """
    read = [_readings(image, edge) for image in images_by_both]
    mean, error = np.array([each[0] for each in read]), np.array([each[1] for each in read])
    scatter = np.sqrt(mean.var(axis=0, ddof=1).mean(axis=0) / (error**2).mean(axis=(0, 1)))
    assert (np.abs(scatter - 1.0) <= 4.0 / math.sqrt(2.0 * (_SEEDS - 1))).all(), scatter
    others = (mean.sum(axis=0) - mean) / (_SEEDS - 1)
    # The others' mean has an error, too.
    wide = CONFIDENCE * math.sqrt(1.0 + 1.0 / (_SEEDS - 1)) * error
    rates = (np.abs(mean - others) <= wide).mean(axis=(0, 1))
    assert (rates >= 0.95 - SKEW - 4.0 * math.sqrt(0.95 * 0.05 / _SEEDS)).all(), rates


def _readings(image: ImageMoments, edge: int) -> tuple[Values, Values]:
    """X, Y, Z, u' and v' of all regions with such an edge, and their errors."""
    means, errors = [], []
    for y in range(0, _FILM, edge):
        for x in range(0, _FILM, edge):
            chosen = np.zeros((_FILM, _FILM), dtype=np.bool_)
            chosen[y : y + edge, x : x + edge] = True
            reading = read_region(image, chosen)
            assert reading is not None
            means.append([*reading.mean[:3], *reading.chromaticity])
            errors.append([*reading.error[:3], *reading.chromaticity_error])
    return np.array(means), np.array(errors)
