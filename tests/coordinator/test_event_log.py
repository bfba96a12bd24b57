"""The log of a coordinator's events and instructions, written and replayed."""

import dataclasses
import json
import logging
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nocturne_coordinator import replay as program
from nocturne_coordinator.dispatch.events import Moment, RendersSeen, ResultCame, Tick
from nocturne_coordinator.dispatch.instructions import Instruction
from nocturne_coordinator.dispatch.records import FailedTile, OpenRender, RenderState, Totals
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.event_log import EventLog, decoded, encoded
from nocturne_coordinator.main import EXIT_UNUSABLE
from nocturne_scene.ranges import make_schedule

from tests.coordinator.service import Service, check_complete
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.coordinator.world import World
from tests.system.waiting import LIMIT_S

AT = Moment(12.5, 1.7e9)


def night(log: Path) -> None:
    """A render from its first range to its last, written down."""
    world = World(event_log=log)
    world.start()
    world.worker()
    world.worker()
    world.check_survived(world.create(100))
    world.close_log()


@given(st.binary(), st.floats(0.0, 1.0), st.text())
def test_events_are_read_as_they_were_written(data: bytes, draw: float, reason: str) -> None:
    row = OpenRender(
        "r",
        RenderState.RUNNING,
        make_schedule(70, 40, 50, ["rod"]),
        "5c" * 32,
        7,
        Totals(photons=3, cpu_seconds=0.1),
        StopConditions(tile_samples=(4, 0), until_text="07:00Z"),
        failed_tiles=(FailedTile(1, 0, 4, reason, ("a", "b")),),
        look_first=Region(0, 0, 3, 4),
    )
    for event in (
        ResultCame(AT, b"1-0", data, draw),
        RendersSeen(AT, (row,), {"w": reason}, 2),
        Tick(AT),
    ):
        assert decoded(json.loads(json.dumps(encoded(event)))) == event


def test_only_what_an_event_log_has_is_read() -> None:
    with pytest.raises(ValueError, match="Popen"):
        decoded({"~Popen": {"args": "rm"}})


def test_a_night_is_shown_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    night(tmp_path / "events")
    assert program.main([str(tmp_path / "events")]) == 0
    said = capsys.readouterr().out
    assert "render=r0 started; 0 of 12 ranges are merged" in said
    assert "render=r0 SUCCEEDED" in said
    assert said.splitlines()[-1].endswith("instructions: the same as then")


def test_another_decision_is_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "events"
    night(log)
    lines = log.read_text().splitlines()
    head = json.loads(lines[0])
    settings = dataclasses.replace(Settings(), commit_seconds=30.0)
    head["head"] = encoded({"settings": settings, "quarantined": {}})
    log.write_text("\n".join([json.dumps(head), *lines[1:], ""]))
    assert program.main([str(log)]) == 1
    assert "Commit" in capsys.readouterr().err


@pytest.mark.parametrize("kept", [0.3, 0.7, 0.99])
def test_a_log_that_was_cut_off_is_replayed_so_far(tmp_path: Path, kept: float) -> None:
    log = tmp_path / "events"
    night(log)
    whole = log.read_bytes()
    log.write_bytes(whole[: int(kept * len(whole))])
    assert program.main([str(log)]) == 0


def test_its_size_is_bounded(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    log = tmp_path / "events"
    writer = EventLog(log, Settings(), {}, max_bytes=20_000)
    nothing: list[Instruction] = []
    with caplog.at_level(logging.WARNING):
        for _ in range(1000):
            list(writer.recorded(Tick(AT), (each for each in nothing)))
    assert 18_000 < log.stat().st_size <= 20_020
    assert json.loads(log.read_text().splitlines()[-1]) == {"full": True}
    assert len(caplog.records) == 1
    writer.close()


def test_the_one_before_is_kept_and_nobody_else_reads_it(tmp_path: Path) -> None:
    for number in range(3):
        EventLog(tmp_path / "events", Settings(number=number), {}).close()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["events", "events.1"]
    assert '"number":1' in (tmp_path / "events.1").read_text()
    assert (tmp_path / "events").stat().st_mode & 0o077 == 0


def test_a_disk_that_is_full_ends_it_and_nothing_else(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    writer = EventLog(tmp_path / "events", Settings(), {})
    writer.close()
    writer._file = Path("/dev/full").open("w")  # noqa: SIM115 - closed with the log
    nothing: list[Instruction] = []
    with caplog.at_level(logging.ERROR):
        for _ in range(10):
            list(writer.recorded(Tick(AT), (each for each in nothing)))
    assert "the event log ends here" in caplog.text
    writer.close()


def test_a_log_that_can_not_be_written_is_said_at_the_start(service: Service, tmp_path: Path) -> None:
    assert service.start("", "--event-log", str(tmp_path / "gone" / "events")).wait(LIMIT_S) == EXIT_UNUSABLE


def test_a_real_coordinators_log_is_replayed(
    service: Service, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And has no password, which Redis does not ask for here."""
    monkeypatch.setenv("NOCTURNE_REDIS_PASSWORD", "")
    log = tmp_path / "events"
    service.start("", "--event-log", str(log))
    render = service.create(samples=60)
    service.work(SimulatedWorker(service.server.url))
    check_complete(service, render.id)
    assert service.stop() == 0
    assert program.main([str(log)]) == 0
    assert str(os.fspath(service.server.url)) not in log.read_text()
