"""What the core has decided is written to the folder, also where the first try fails."""

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch import instructions as do
from nocturne_coordinator.dispatch.core import Core
from nocturne_coordinator.dispatch.events import RendersSeen, ResultCame, StreamIsReady, Tick, WorkersSeen
from nocturne_coordinator.dispatch.records import WorkerRow
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.errors import StoreUnavailable

from tests.coordinator.simulated_worker import simulated_result
from tests.coordinator.test_core import Shell, at, row

_WORKERS = ("liar", "a", "b")


class Audited(Shell):
    """A render of which every result is audited, and three workers."""

    def __init__(self) -> None:
        super().__init__((row("r", 2000),))
        self.core = Core(Settings(commit_seconds=0.5, audit_share=1.0, audit_share_new=1.0))
        self.take_up()
        seen = tuple(WorkerRow(name, job_pb2.ENGINE_CURRENT, 1, 0, 0, 0.0, 0, 1.0, 1.0) for name in _WORKERS)
        self.tell(WorkersSeen(at(0.0), seen, dict.fromkeys(_WORKERS, 10_000), (), 0))

    def first_range(self, worker: str, now: float, wrong: bool = False) -> list[do.Instruction]:
        """A worker's result of the first range of the first tile comes."""
        planned = self.core.state.renders["r"].planned
        result = simulated_result(planned.job(0, planned.ranges[0]), worker)
        result.partial.rays += wrong
        return self.tell(ResultCame(at(now), self.entry(), result.SerializeToString(), 0.0))

    def convict(self) -> list[do.Instruction]:
        """Two others say that a result of the faulty worker was wrong."""
        self.first_range("a", 0.3)
        self.tell(StreamIsReady(at(0.4)))
        return self.first_range("b", 0.5)


def accused() -> Audited:
    """The faulty worker's result is merged, and its audit on the stream."""
    shell = Audited()
    shell.tell(StreamIsReady(at(0.1)))
    shell.first_range("liar", 0.2, wrong=True)
    shell.tell(StreamIsReady(at(0.25)))
    return shell


def written(followed: list[do.Instruction]) -> list[tuple[str, bool]]:
    return [(each.worker, each.mismatched) for each in followed if isinstance(each, do.Quarantine)]


@pytest.mark.parametrize("fails", [do.Commit, do.Quarantine])
def test_a_liar_is_in_quarantine_though_the_folder_fails_at_first(fails: type[do.Instruction]) -> None:
    shell = accused()
    works = shell.answers[fails]
    shell.answers[fails] = lambda _: StoreUnavailable("full")
    shell.convict()
    shell.tell(Tick(at(0.6)))
    # The folder knows nothing of it, and is looked at.
    shell.tell(RendersSeen(at(0.7), shell.rows, {}, 1))
    assert list(shell.core.state.fleet.quarantined) == ["liar"]
    shell.tell(Tick(at(2.0)))
    shell.answers[fails] = works
    shell.answers[do.Quarantine] = lambda _: ["r"]
    followed = shell.tell(Tick(at(4.0)))
    assert written(followed) == [("liar", True)]
    # Its work is not in memory any more either.
    assert any(isinstance(each, do.ReleaseLease) for each in followed)
    assert shell.core.state.renders == {}
    assert written(shell.tell(Tick(at(6.0)))) == []


def test_who_failed_first_and_is_found_lying_then_is_distrusted() -> None:
    shell = accused()
    reason = "It failed at three jobs that other workers could do."
    shell.tell(RendersSeen(at(0.25), shell.rows, {"liar": reason}, 1))
    shell.convict()
    assert written(shell.tell(Tick(at(0.6)))) == [("liar", True)]


def test_a_render_is_let_go_though_the_folder_fails_at_first() -> None:
    shell = Shell((row("r"),))
    shell.take_up()
    shell.answers[do.ReleaseLease] = lambda _: StoreUnavailable("busy")
    shell.tell(RendersSeen(at(1.0), (), {}, 1))
    assert shell.core.state.renders == {}
    shell.tell(Tick(at(2.0)))
    del shell.answers[do.ReleaseLease]
    assert do.ReleaseLease("r", 1) in shell.tell(Tick(at(4.0)))
    assert do.ReleaseLease("r", 1) not in shell.tell(Tick(at(6.0)))


def test_no_image_is_called_final_while_a_liar_is_not_noted() -> None:
    shell = Shell((row("r", 4),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    for tile in range(2):
        shell.result("r", 0.2, tile)
    shell.core.state.owed.append(do.Quarantine("w", "It lied.", True))
    works = shell.answers[do.Quarantine]
    shell.answers[do.Quarantine] = lambda _: StoreUnavailable("full")
    ended = [shell.tell(Tick(at(now))) for now in (0.5, 1.5, 2.5)]
    assert do.EndRender not in {type(each) for followed in ended for each in followed}
    shell.answers[do.Quarantine] = works
    assert written(shell.tell(Tick(at(3.5)))) == [("w", True)]
    assert do.EndRender in {type(each) for each in shell.tell(Tick(at(4.5)))}
