"""Logs of `nocturne up` outlive its next starts, and do not grow without end."""

from pathlib import Path

import pytest
from nocturne_client.local import kept_logs


def test_those_of_the_last_starts_are_kept(tmp_path: Path) -> None:
    log = tmp_path / "api.log"
    for start in range(7):
        kept_logs.begin(log)
        log.write_text(f"start {start}")
    kept = {path.name: path.read_text() for path in tmp_path.iterdir()}
    assert kept == {"api.log": "start 6"} | {f"api.log.{n}": f"start {6 - n}" for n in range(1, 5)}


def test_one_that_is_written_is_begun_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_logs, "MAX_BYTES", 10)
    log = tmp_path / "api.log"
    with log.open("ab", buffering=0) as writer:
        writer.write(b"0123456789")
        kept_logs.bound(log)
        assert list(tmp_path.iterdir()) == [log]
        writer.write(b"too much")
        kept_logs.bound(log)
        writer.write(b"goes on")
    assert log.read_bytes() == b"goes on"
    assert (tmp_path / "api.log.1").read_bytes() == b"0123456789too much"
