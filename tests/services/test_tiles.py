"""Committed tiles as floats: their bytes, omitted tiles, and their names in the event stream."""

import asyncio
import json
import struct
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_api.operations.images import Images
from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.dispatch.records import RenderCommit, TileRow, Totals
from nocturne_coordinator.output.images import Provenance, write_image
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership
from nocturne_scene.tile_sums import TileSums

from tests import sums

WIDTH, HEIGHT, TILE = 40, 30, 32
"""Two tiles: 32 x 30 and 8 x 30."""


class Committer:
    """Commits samples as a coordinator does."""

    def __init__(self, folder: DataFolder) -> None:
        self.ownership = Ownership(folder.root, folder.database)
        self.ledger = Ledger(folder.database, self.ownership)

    def commit(self, render_id: str, tiles: dict[int, tuple[int, TileSums, int]]) -> None:
        """By tile: samples, sums and invalid samples."""
        rows = [
            TileRow(index, n, of_tile.encode(), invalid_samples)
            for index, (n, of_tile, invalid_samples) in tiles.items()
        ]
        held = self.ledger.renders.take(render_id)
        assert held is not None
        self.ledger.commits.commit([RenderCommit(render_id, held.fence, rows, Totals(photons=1), 0.0)])


@pytest.fixture
async def committer(folder: DataFolder) -> AsyncIterator[Committer]:
    committer = Committer(folder)
    yield committer
    committer.ownership.release()


def sums_of(samples: int, width: int) -> TileSums:
    """Sums over `samples` samples, all different."""
    rng = np.random.default_rng(samples * 100 + width)
    return sums.sums_of(rng.gamma(2.0, 3.0, (samples, HEIGHT, width, 3)))


def decode(content: bytes) -> tuple[tuple[int, ...], dict[int, tuple[tuple[int, ...], npt.NDArray[Any]]]]:
    """Header without its magic; by tile (samples, invalid samples, revision) and pixels. By
    docs/reference/api.md alone."""
    assert content[:4] == b"NXY1"
    header = struct.unpack_from("<7I", content, 4)
    offset, tiles = 32, {}
    for _ in range(header[3]):
        index, *about = struct.unpack_from("<4I", content, offset)
        shape = (HEIGHT, TILE if index == 0 else WIDTH - TILE, 4)
        pixels = np.frombuffer(content, "<f4", int(np.prod(shape)), offset + 16).reshape(shape)
        tiles[index] = (tuple(about), pixels)
        offset += 16 + pixels.nbytes
    assert offset == len(content)
    return header, tiles


async def _created(rest: httpx.AsyncClient, body: dict[str, Any]) -> str:
    return str((await rest.post("/v1/renders", json=body)).json()["id"])


async def test_pixels_are_those_of_the_exr(
    body: dict[str, Any], rest: httpx.AsyncClient, committer: Committer, tmp_path: Path
) -> None:
    render_id = await _created(rest, body)
    left, right = sums_of(8, TILE), sums_of(4, WIDTH - TILE)
    committer.commit(render_id, {0: (8, left, 3), 1: (4, right, 0)})
    answer = await rest.get(f"/v1/renders/{render_id}/tiles")
    header, tiles = decode(answer.content)
    revision = (await rest.get(f"/v1/renders/{render_id}")).json()["sequence"]
    assert header == (WIDTH, HEIGHT, TILE, 2, 0, revision, 1)
    assert [about for about, _ in tiles.values()] == [(8, 3, revision), (4, 0, revision)]

    counts = np.full((HEIGHT, WIDTH), 8, dtype=np.uint32)
    counts[:, TILE:] = 4
    whole = np.concatenate([left.pixels, right.pixels], axis=1)
    squares = Squares(
        np.concatenate([left.block_products, right.block_products], axis=1),
        np.concatenate([left.tile_products, right.tile_products])[None],
        TILE,
    )
    write_image(tmp_path / "a.exr", whole, counts, squares, Provenance("", "", 1))
    exr = oiio.ImageBuf(str(tmp_path / "a.exr"))
    channels = [exr.spec().channelnames.index(name) for name in ("X", "Y", "Z", "Y.stderr")]
    expected = np.asarray(exr.get_pixels(oiio.FLOAT))[..., channels]
    assert np.array_equal(np.concatenate([tiles[0][1], tiles[1][1]], axis=1), expected)


async def test_only_what_changed_comes_again(
    body: dict[str, Any], rest: httpx.AsyncClient, committer: Committer
) -> None:
    render_id = await _created(rest, body)
    address = f"/v1/renders/{render_id}/tiles"
    assert decode((await rest.get(address)).content)[1] == {}
    committer.commit(render_id, {0: (4, sums_of(4, TILE), 0), 1: (4, sums_of(4, WIDTH - TILE), 0)})
    first = await rest.get(address)
    since = first.headers["etag"].strip('"')
    again = await rest.get(address, params={"since": since}, headers={"If-None-Match": f'"{since}"'})
    assert (again.status_code, again.content) == (304, b"")
    committer.commit(render_id, {1: (8, sums_of(8, WIDTH - TILE), 0)})
    changed = await rest.get(address, params={"since": since}, headers={"If-None-Match": f'"{since}"'})
    assert list(decode(changed.content)[1]) == [1]
    assert len(changed.content) == 32 + 16 + 16 * HEIGHT * (WIDTH - TILE)


async def test_large_answers_come_in_parts(
    body: dict[str, Any],
    rest: httpx.AsyncClient,
    committer: Committer,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("nocturne_api.files.tiles.TILES_ANSWER_BYTES", 16 * TILE * TILE)
    render_id = await _created(rest, body)
    committer.commit(render_id, {0: (4, sums_of(4, TILE), 0), 1: (4, sums_of(4, WIDTH - TILE), 0)})
    found, since, more = [], "", 1
    while more:
        answer = await rest.get(f"/v1/renders/{render_id}/tiles", params={"since": since})
        header, tiles = decode(answer.content)
        since, more = answer.headers["etag"].strip('"'), header[4]
        found += list(tiles)
    assert found == [0, 1]


@pytest.mark.parametrize("since", ["x", "1", "-1.0", "1.2.3", "4294967296.0"])
async def test_a_cursor_that_was_not_given_out(
    since: str, body: dict[str, Any], rest: httpx.AsyncClient
) -> None:
    render_id = await _created(rest, body)
    answer = await rest.get(f"/v1/renders/{render_id}/tiles", params={"since": since})
    assert answer.status_code == 422
    assert answer.json()["problems"][0]["place"] == "query.since"


@pytest.mark.parametrize("waits", [0.0, 0.3])
async def test_the_stream_names_changed_tiles(
    waits: float,
    body: dict[str, Any],
    rest: httpx.AsyncClient,
    committer: Committer,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Once for each change, also where the next one is committed before the tiles are asked for."""
    asked = Images.changed_tiles

    async def later(*arguments: Any) -> list[tuple[int, int]]:
        await asyncio.sleep(waits)
        return await asked(*arguments)

    monkeypatch.setattr(Images, "changed_tiles", later)
    render_id = await _created(rest, body)
    other = await _created(rest, {**body, "request_id": "other"})
    named: list[list[list[int]]] = []
    async with asyncio.timeout(10), rest.stream("GET", f"/v1/events?render={render_id}") as stream:
        event = ""
        async for line in stream.aiter_lines():
            event = line.removeprefix("event: ") if line.startswith("event: ") else event
            if not line.startswith("data: "):
                continue
            data = json.loads(line[6:])
            assert data.get("id", data.get("render")) == render_id
            if event == "tiles":
                named.append(data["tiles"])
            elif data["sequence"] == 1:
                committer.commit(other, {0: (4, sums_of(4, TILE), 0)})
                committer.commit(render_id, {0: (4, sums_of(4, TILE), 0), 1: (4, sums_of(4, 8), 0)})
            if len(named) == 1 and event == "tiles":
                committer.commit(render_id, {1: (8, sums_of(8, 8), 0)})
            if len(named) == 2:
                break
    assert named == [[[0, 1]], [[1, 1]]]


async def test_a_stream_of_renders_that_are_not_there_or_too_many(
    body: dict[str, Any], rest: httpx.AsyncClient
) -> None:
    assert (await rest.get("/v1/events", params={"render": "r-none"})).status_code == 404
    many = [await _created(rest, {**body, "request_id": f"r{index}"}) for index in range(5)]
    answer = await rest.get("/v1/events", params={"render": many})
    assert (answer.status_code, answer.json()["problems"][0]["place"]) == (422, "query.render")
