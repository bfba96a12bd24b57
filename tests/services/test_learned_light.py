"""What a pilot learned of the light at a pixel, against Snell's law."""

import math
from typing import Any

import httpx
import numpy as np
import pytest
from nocturne_api.children import pools
from nocturne_api.places import Places

from tests.pool import FILM, SAMPLES, light_at_the_middle, pool


@pytest.fixture
def guided_body() -> dict[str, Any]:
    return {
        "request_id": "pool",
        "name": "pool",
        "scene": pool(),
        "width": FILM[0],
        "height": FILM[1],
        "samples": SAMPLES,
    }


@pytest.fixture
async def guided(rest: httpx.AsyncClient, guided_body: dict[str, Any]) -> str:
    render = (await rest.post("/v1/renders", json=guided_body)).json()
    assert render["guided"], render["way"]
    return f"/v1/renders/{render['id']}/learned-light"


async def test_light_in_a_pool_comes_as_snell_has_it(rest: httpx.AsyncClient, guided: str) -> None:
    """Cones come from light that was learned nearby: within 0.2 m, that is 6 degrees."""
    found = (await rest.get(guided, params={"x": FILM[0] // 2, "y": FILM[1] // 2})).json()
    assert found["normal"] == pytest.approx([0, 0, 1])
    assert found["direction"] == pytest.approx([0, 0, -1], abs=1e-5)
    assert found["interfaces"] == 1
    axes = np.array([each["axis"] for each in found["cones"]])
    assert 8 <= len(axes) <= 32
    assert np.linalg.norm(axes, axis=1) == pytest.approx(1.0, abs=1e-4)
    away = np.degrees(np.arccos(np.clip(axes @ light_at_the_middle(), -1.0, 1.0)))
    assert np.median(away) < 6.0
    assert all(0.0 < each["half_angle_degrees"] <= 180.0 for each in found["cones"])


async def test_a_place_without_a_pixel_is_told(rest: httpx.AsyncClient, guided: str) -> None:
    answer = await rest.get(guided, params={"x": FILM[0], "y": 0})
    assert answer.status_code == 422
    assert "film" in answer.text


async def test_others_wait_and_nothing_hangs(
    rest: httpx.AsyncClient, guided: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = {"x": 1, "y": 1}
    monkeypatch.setattr(pools, "_lookups", Places(0, 0, "try again"))
    answer = await rest.get(guided, params=place)
    assert answer.status_code == 503
    assert "try again" in answer.json()["detail"]
    monkeypatch.setattr(pools, "_lookups", Places(1, 0, "try again"))
    monkeypatch.setattr(pools, "LEARNED_WALL_S", 1e-3)
    answer = await rest.get(guided, params=place)
    assert answer.status_code == 503
    assert "0.001 s" in answer.json()["detail"]


async def test_a_render_without_guide_says_so(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    render = (await rest.post("/v1/renders", json=body)).json()
    assert not render["guided"]
    answer = await rest.get(f"/v1/renders/{render['id']}/learned-light", params={"x": 0, "y": 0})
    assert answer.status_code == 404
    assert "guided" in answer.json()["detail"]


async def test_a_scene_that_cant_be_read_is_no_failure_of_the_service(
    rest: httpx.AsyncClient, guided: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As one of a program of another version, or without nocturne-trace."""
    monkeypatch.setattr(pools, "_LOOK_UP", ("-c", "import sys; sys.exit(1)"))
    answer = await rest.get(guided, params={"x": 1, "y": 1})
    assert answer.status_code == 404
    assert "can't be looked up" in answer.json()["detail"]


def test_snell_is_kept() -> None:
    """Of the expectation itself: the sines on both sides of the water, at the place where it goes through."""
    x, y, z = light_at_the_middle()
    assert math.hypot(x, y, z) == pytest.approx(1.0)
    assert z > math.cos(math.asin(1 / 1.33))
