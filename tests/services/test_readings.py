"""What a part of an image shows, in numbers, by the formula of one place."""

from typing import Any

import httpx
import numpy as np
import pytest
from nocturne_client.contract import LinearPolarisation, Reading, ReadValue, Region
from nocturne_client.errors import NocturneClientError
from nocturne_client.readings import parse_region, sentence
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.tile_sums import TileSums

from tests.services.test_tiles import HEIGHT, TILE, WIDTH, Committer
from tests.sums import sums_of

SAMPLES = 16


@pytest.fixture
def drawn() -> np.ndarray[Any, Any]:
    """Samples of a film in which the pixels of a block share a part of their light."""
    rng = np.random.default_rng(3)
    shared = rng.gamma(2.0, 3.0, (SAMPLES, 8, 10, 3)).repeat(4, axis=1).repeat(4, axis=2)
    return shared[:, :HEIGHT] + rng.gamma(2.0, 3.0, (SAMPLES, HEIGHT, WIDTH, 3))


@pytest.fixture
async def rendered(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder, drawn: np.ndarray[Any, Any]
) -> str:
    render_id = str((await rest.post("/v1/renders", json=body)).json()["id"])
    committer = Committer(folder)
    tiles: dict[int, tuple[int, TileSums, int]] = {
        0: (SAMPLES, sums_of(drawn[:, :, :TILE]), 3),
        1: (SAMPLES, sums_of(drawn[:, :, TILE:]), 0),
    }
    committer.commit(render_id, tiles)
    committer.ownership.release()
    return render_id


async def test_a_region_across_tiles_has_means_and_errors(
    rest: httpx.AsyncClient, rendered: str, drawn: np.ndarray[Any, Any]
) -> None:
    """The errors of what its samples, each the region's mean, have as spread."""
    asked = {"x": 28, "y": 4, "width": 8, "height": 8}
    read = (await rest.get(f"/v1/renders/{rendered}/reading", params=asked)).json()
    of_samples = drawn[:, 4:12, 28:36].mean(axis=(1, 2))
    assert [each["name"] for each in read["values"]] == ["X", "Y", "Z"]
    assert [each["mean"] for each in read["values"]] == pytest.approx(of_samples.mean(axis=0))
    expected = of_samples.std(axis=0, ddof=1) / np.sqrt(SAMPLES)
    # Pixels that are taken as independent would have 0.35 of it; an error of 16 samples is known to 18 %.
    assert [each["standard_error"] for each in read["values"]] == pytest.approx(expected, rel=0.45)
    assert read["correlation"] > 4.0
    assert (read["pixels"], read["samples"], read["zero_pixels"]) == (64, 64 * SAMPLES, 0)
    assert (read["fewest_samples"], read["most_samples"], read["invalid_samples"]) == (SAMPLES, SAMPLES, 3)
    assert read["region"] == asked
    assert (read["quantity"], read["unit"]) == ("luminance", "cd/m2")
    assert read["u_prime_error"] > 0.0


async def test_a_pixel_has_the_error_of_its_own_samples_and_of_one_more_find(
    rest: httpx.AsyncClient, rendered: str, drawn: np.ndarray[Any, Any]
) -> None:
    asked = {"x": 5, "y": 6, "width": 1, "height": 1}
    read = (await rest.get(f"/v1/renders/{rendered}/reading", params=asked)).json()
    expected = drawn[:, 6, 5].std(axis=0, ddof=1) / np.sqrt(SAMPLES)
    more = np.array([each["standard_error"] for each in read["values"]]) / expected
    assert ((more > 1.0) & (more < 1.01)).all()
    assert read["correlation"] == 1.0


@pytest.mark.parametrize("region", [(40, 0, 1, 1), (0, 0, 41, 1), (0, 0, 1, 0), (-1, 0, 1, 1)])
async def test_a_region_outside_of_the_film_is_refused(
    rest: httpx.AsyncClient, rendered: str, region: tuple[int, int, int, int]
) -> None:
    asked = dict(zip(("x", "y", "width", "height"), region, strict=True))
    answer = await rest.get(f"/v1/renders/{rendered}/reading", params=asked)
    assert answer.status_code == 422
    assert "within the film of 40 x 30" in answer.text


async def test_what_has_no_samples_yet_is_not_found(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    answer = await rest.get(f"/v1/renders/{render_id}/reading")
    assert answer.status_code == 404
    assert "no samples there yet" in answer.text


# --- in words ---


def reading(**fields: Any) -> Reading:
    values = [ReadValue("X", 12.0, 0.5), ReadValue("Y", 10.0, 0.7), ReadValue("Z", 8.0, 0.4)]
    whole: dict[str, Any] = {
        "region": Region(5, 5, 2, 2),
        "quantity": "illuminance",
        "unit": "lx",
        "response_unit": "W m-2",
        "values": values,
        "u_prime": 0.2,
        "v_prime": 0.45,
        "u_prime_error": 0.001,
        "v_prime_error": 0.002,
        "correlation": 1.0,
        "coverage_factor": 2.0,
        "pixels": 4,
        "zero_pixels": 0,
        "samples": 64,
        "fewest_samples": 16,
        "most_samples": 16,
        "invalid_samples": 0,
        "linear_polarisation": None,
    }
    return Reading(**(whole | fields))


def test_a_reading_says_all_quantities_with_their_intervals() -> None:
    assert sentence(reading()) == (
        "illuminance 10 +- 1.4 lx, u' 0.2000 +- 0.002, v' 0.4500 +- 0.004, X 12 +- 1, Z 8 +- 0.8 (95 %)"
    )
    assert "rod 0.5 +- 0.2" in sentence(reading(values=[*reading().values, ReadValue("rod", 0.5, 0.1)]))
    assert "nothing seen in 1 of 4 pixels" in sentence(reading(zero_pixels=1))


def test_polarised_light_has_degree_and_angle() -> None:
    found = LinearPolarisation(0.31234, [0.3, 0.325], 87.25, 0.42)
    told = "linearly polarised by 0.3123 (0.3 to 0.325), at 87.2 +- 0.42 degrees (95 %)"
    assert sentence(reading(linear_polarisation=found)).endswith(told)
    unknown = sentence(reading(linear_polarisation=LinearPolarisation(0.3, [], 87.25, None)))
    assert "linearly polarised by 0.3, at 87.2 degrees" in unknown


def test_what_saw_nothing_says_so_with_a_bound() -> None:
    dark = [ReadValue(name, 0.0, None) for name in "XYZ"]
    assert sentence(reading(values=dark, u_prime=None)) == (
        "nothing seen: none of 64 samples met light, so fewer than 1 in 21 meet any (95 %)"
    )


def test_an_older_renders_numbers_have_no_unit() -> None:
    assert sentence(reading(quantity="", unit="")).startswith("Y 10 +- 1.4, u'")


@pytest.mark.parametrize(
    "text", ["", "1", "1,2,3", "1,2,3,4,5", "a,b", "-1,0", "1.5,2", "0,0,0,1", "0,0 64,64"]
)
def test_what_is_no_region_is_refused(text: str) -> None:
    with pytest.raises(NocturneClientError, match=r"expected X,Y,WIDTH,HEIGHT|has no pixels"):
        parse_region(text)
