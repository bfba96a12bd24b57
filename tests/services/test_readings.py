"""What a part of an image shows, in numbers."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Region
from nocturne_client.readings import Reading, parse_region, read_region
from nocturne_client.tiles import Tile, TileAnswer


class FakeClient:
    """Two tiles of a film of 40 by 8 pixels, in two answers."""

    def tiles(self, render_id: str, since: str = "") -> TileAnswer:
        assert render_id == "r-1"
        x, width = (32, 8) if since else (0, 32)
        pixels = np.zeros((8, width, 4), dtype=np.float32)
        pixels[..., :3] = 10.0 + x
        pixels[..., 3] = 2.0
        pixels[0, 0] = 0.0
        return TileAnswer(40, 8, [Tile(x, 0, 64, 0, pixels)], more=not since, cursor="1.1")


class FakeRender:
    id, width, height, quantity, unit = "r-1", 40, 8, "illuminance", "lx"


def read(text: str) -> Reading:
    client: Any = FakeClient()
    render: Any = FakeRender()
    return read_region(client, render, parse_region(text))


def test_a_region_across_tiles_has_its_mean_error_and_unit() -> None:
    found = read("31,2,2,4")
    assert found.value == pytest.approx((10.0 + 42.0) / 2)
    assert found.standard_error == pytest.approx(2.0 / np.sqrt(8))
    assert (found.pixels, found.samples, found.unseen_pixels) == (8, 8 * 64, 0)
    assert str(found) == "illuminance 26 +- 1.4 lx (95 %)"


def test_a_pixel_that_saw_nothing_says_so_with_a_bound() -> None:
    found = read("0,0")
    assert (found.value, found.standard_error) == (0.0, None)
    assert str(found) == "nothing seen: none of 64 samples met light, so fewer than 1 in 21 meet any (95 %)"
    assert "nothing seen in 1 of 4 pixels" in str(read("0,0,2,2"))


@pytest.mark.parametrize("text", ["", "1", "1,2,3", "1,2,3,4,5", "a,b", "-1,0", "1.5,2"])
def test_what_is_no_region_is_refused(text: str) -> None:
    with pytest.raises(NocturneClientError, match="expected X,Y,WIDTH,HEIGHT"):
        parse_region(text)


@pytest.mark.parametrize("text", ["40,0", "0,0,41,1", "0,0,0,1"])
def test_a_region_outside_of_the_film_is_refused(text: str) -> None:
    with pytest.raises(NocturneClientError, match="not within the film of 40 x 8"):
        read(text)


def test_an_older_renders_numbers_have_no_unit() -> None:
    found = replace(read("5,5"), quantity="", unit="", region=Region(5, 5, 1, 1))
    assert str(found) == "Y 10 +- 3.9 (95 %)"
