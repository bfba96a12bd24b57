"""Image files from elsewhere, as the page compares renders with."""

from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import numpy as np
import OpenEXR
import pytest
from nocturne_api.places import Places

TYPE = "application/vnd.nocturne.tiles"


def exr(path: Path, compression: object, **channels: np.ndarray) -> bytes:
    header = {"type": OpenEXR.scanlineimage, "compression": compression}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))
    return path.read_bytes()


async def test_a_picture_of_any_compression_becomes_tiles(tmp_path: Path, rest: httpx.AsyncClient) -> None:
    random = np.random.default_rng(1)
    planes = {name: random.random((40, 70)).astype(np.float32) for name in ("X", "Y", "Z", "Y.stderr")}
    counts = np.full((40, 70), 2**24 + 1, dtype=np.uint32)
    content = exr(tmp_path / "a.exr", OpenEXR.PIZ_COMPRESSION, **planes, n=counts)
    answer = await rest.post("/v1/pictures?tile_size=32", content=content)
    assert (answer.status_code, answer.headers["content-type"]) == (200, TYPE)
    words = np.frombuffer(answer.content, dtype="<u4")
    assert answer.content[:4] == b"NXY1"
    assert words[1:8].tolist() == [70, 40, 32, 6, 0, 0, 5]
    at = 8
    for index, (y, x) in enumerate((y, x) for y in (0, 32) for x in (0, 32, 64)):
        assert words[at : at + 4].tolist() == [index, 2**24 + 1, 0, 0]
        expected = np.stack([plane[y : y + 32, x : x + 32] for plane in planes.values()], axis=-1)
        size = expected.size
        assert np.array_equal(words[at + 4 : at + 4 + size].view("<f4"), expected.ravel())
        at += 4 + size
    assert at == len(words)


@pytest.mark.parametrize("content", [b"", b"v/1\x01", b"\x76\x2f\x31\x01\x02\x00\x00\x00channels\x00"])
async def test_what_is_no_picture_is_refused(rest: httpx.AsyncClient, content: bytes) -> None:
    answer = await rest.post("/v1/pictures", content=content)
    assert (answer.status_code, answer.json()["reason"]) == (422, "INVALID_INPUT")


async def test_a_picture_that_is_cut_short_is_refused(tmp_path: Path, rest: httpx.AsyncClient) -> None:
    planes = {name: np.ones((64, 64), dtype=np.float32) for name in "RGB"}
    whole = exr(tmp_path / "a.exr", OpenEXR.NO_COMPRESSION, **planes)
    answer = await rest.post("/v1/pictures", content=whole[: len(whole) // 2])
    assert answer.status_code == 422


async def test_bounds_of_size_and_number(
    tmp_path: Path, rest: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    content = exr(tmp_path / "a.exr", OpenEXR.NO_COMPRESSION, Y=np.ones((8, 8), dtype=np.float32))
    monkeypatch.setattr("nocturne_api.rest.pictures.PICTURE_BYTES", len(content) - 1)
    assert (await rest.post("/v1/pictures", content=content)).status_code == 422

    async def undeclared() -> AsyncIterator[bytes]:
        yield content

    assert (await rest.post("/v1/pictures", content=undeclared())).status_code == 422
    monkeypatch.undo()
    assert (await rest.post("/v1/pictures", content=content)).status_code == 200
    monkeypatch.setattr("nocturne_api.children.pools._pictures", Places(0, 0, "are being read"))
    assert (await rest.post("/v1/pictures", content=content)).status_code == 503
