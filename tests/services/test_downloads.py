"""Files that the client fetches, over connections that are lost."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from nocturne_client import Client


class _BreaksOff(httpx.SyncByteStream):
    def __init__(self, content: bytes) -> None:
        self._content = content

    def __iter__(self) -> Iterator[bytes]:
        yield self._content
        raise httpx.ReadError("the connection was lost")


@pytest.mark.parametrize("is_another", [False, True])
def test_a_download_that_broke_off_goes_on(
    is_another: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the file is another one by now, from its beginning."""
    monkeypatch.setattr("nocturne_client.transport.RETRY_DELAYS_S", (0.0, 0.0))
    before, now = b"0123456789" * 1000, b"abc" * 5 if is_another else b"0123456789" * 1000
    asked: list[tuple[str | None, str | None]] = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append((request.headers.get("range"), request.headers.get("if-range")))
        first = asked[-1][0]
        if first is None:
            return httpx.Response(200, stream=_BreaksOff(before[:1000]), headers={"ETag": '"a"'})
        if is_another:
            return httpx.Response(200, content=now, headers={"ETag": '"b"'})
        end = 5000 if first == "bytes=1000-" else len(now)
        rest = now[int(first[6:-1]) : end]
        broken = httpx.Response(206, stream=_BreaksOff(rest), headers={"ETag": '"a"'})
        return broken if end == 5000 else httpx.Response(206, content=rest, headers={"ETag": '"a"'})

    with Client("http://test", transport=httpx.MockTransport(answer)) as client:
        assert client.download("r", "exr", tmp_path / "image.exr").read_bytes() == now
    parts = ["bytes=1000-"] if is_another else ["bytes=1000-", "bytes=5000-"]
    assert asked == [(None, None), *((part, '"a"') for part in parts)]
