"""The core alone: the instructions that follow from each event. Long: one test for each kind of event."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch import instructions as do
from nocturne_coordinator.dispatch.core import Core
from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.events import (
    CommitDone,
    JobsFound,
    MadeApart,
    Moment,
    PicturesMade,
    RedisEmptied,
    RendersSeen,
    ResultCame,
    StreamIsReady,
    Tick,
)
from nocturne_coordinator.dispatch.film import MergedFilm
from nocturne_coordinator.dispatch.range_queue import RangeState
from nocturne_coordinator.dispatch.records import ErrorPoint, OpenRender, RenderState, TileRow, Totals
from nocturne_coordinator.dispatch.scheduler import JobKey
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.dispatch.validation import InvalidState
from nocturne_coordinator.errors import LeaseLost, QueueError, StoreUnavailable
from nocturne_scene.ranges import make_schedule

from tests.coordinator.simulated_worker import simulated_result

Answers = dict[type[Any], Callable[[Any], Any]]


def at(now: float) -> Moment:
    return Moment(now, 1.7e9 + now)


class Shell:
    """Carries nothing out, and gives prepared answers."""

    def __init__(self, rows: tuple[OpenRender, ...]) -> None:
        self.core = Core(Settings(commit_seconds=0.5))
        self.rows = rows
        self._entries = 0
        self.now = at(0.0)
        self.answers: Answers = {
            do.TakeRender: lambda asked: next(row for row in rows if row.id == asked.render_id),
            do.StartRender: lambda _: True,
            do.ReadTiles: lambda _: [],
            do.IsOpen: lambda _: False,
            do.EndRender: lambda _: True,
            do.MakePictures: lambda _: PicturesMade(self.now),
            do.Quarantine: lambda _: [],
            do.Publish: lambda asked: [self.entry() for _ in asked.jobs],
            do.Commit: lambda _: CommitDone(self.now, ()),
            do.AskTime: lambda _: self.now,
            **dict.fromkeys(
                (do.WritePreview, do.WriteThumbnail, do.WriteImage, do.RecordError), lambda _: self.now
            ),
        }

    def entry(self) -> bytes:
        self._entries += 1
        return b"%d-0" % self._entries

    def tell(self, event: Any) -> list[do.Instruction]:
        """Gives the instructions that followed; the state is validated."""
        self.now = event.at
        followed: list[do.Instruction] = []
        steps = self.core.handle(event)
        try:
            instruction = next(steps)
            while True:
                followed.append(instruction)
                answering = self.answers.get(type(instruction))
                answer = answering(instruction) if answering else None
                instruction = steps.throw(answer) if isinstance(answer, Exception) else steps.send(answer)
        except (StopIteration, QueueError):
            self.core.validate_state()
            return [each for each in followed if not isinstance(each, do.Log)]

    def take_up(self, now: float = 0.0) -> list[do.Instruction]:
        return self.tell(RendersSeen(at(now), self.rows, {}, 1))

    def result(self, render_id: str, now: float, tile: int = 0, index: int = 0) -> list[do.Instruction]:
        planned = self.core.state.renders[render_id].planned
        data = simulated_result(planned.job(tile, planned.ranges[index])).SerializeToString()
        return self.tell(ResultCame(at(now), self.entry(), data, 0.99))


def row(name: str, samples: int = 8, **values: Any) -> OpenRender:
    schedule = make_schedule(33, 2, samples)
    engine = values.pop("engine", job_pb2.ENGINE_CURRENT)
    return OpenRender(name, RenderState.QUEUED, schedule, "5c" * 32, engine, Totals(), fence=1, **values)


def kinds(followed: list[do.Instruction]) -> list[str]:
    return [type(each).__name__ for each in followed]


def test_a_render_from_its_first_job_to_its_end() -> None:
    shell = Shell((row("r", 4),))
    assert kinds(shell.take_up()) == ["TakeRender", "StartRender", "ReadTiles", "PublishExclusions"]
    (published,) = shell.tell(StreamIsReady(at(0.1)))
    assert isinstance(published, do.Publish)
    assert published.keys == (("r", 0, 0), ("r", 1, 0))
    assert shell.result("r", 0.2) == []
    assert kinds(shell.tell(Tick(at(0.5))))[:2] == ["Commit", "Acknowledge"]
    assert shell.result("r", 0.6, tile=1) == []
    followed = shell.tell(Tick(at(0.7)))
    # Committed, deleted, shown, and only then ended.
    wanted = ["Commit", "Acknowledge", "WriteImage", "WritePreview", "WriteThumbnail", "RecordError"]
    assert [each for each in kinds(followed) if each in (*wanted, "EndRender", "ReleaseLease")] == [
        *wanted,
        "EndRender",
        "ReleaseLease",
    ]
    assert shell.core.state.renders == {}


def test_a_render_that_waits_for_its_pictures_keeps_nobody_and_gets_no_jobs() -> None:
    shell = Shell((row("large", 2000, stop=StopConditions(wall_seconds=0.3)), row("small", 4)))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    made = PicturesMade(at(0.5))
    shell.answers[do.MakePictures] = lambda asked: None if asked.render_id == "large" else made
    shell.result("large", 0.2)
    for tile in range(2):
        shell.result("small", 0.2, tile)

    def ended(now: float) -> list[str]:
        return [each.render.id for each in shell.tell(Tick(at(now))) if isinstance(each, do.EndRender)]

    assert ended(0.5) == ["small"]
    shell.result("large", 0.6, tile=1)
    assert shell.tell(StreamIsReady(at(0.7))) == []
    assert ended(0.8) == []
    shell.answers[do.MakePictures] = lambda _: made
    # It is asked for once in a commit's time.
    assert (ended(0.9), ended(1.1)) == ([], ["large"])


def test_a_render_does_not_end_before_its_layers_are_made() -> None:
    shell = Shell((row("r", 4, layers_due=True),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    shell.result("r", 0.2)
    shell.result("r", 0.3, tile=1)
    assert "EndRender" not in kinds(shell.tell(Tick(at(0.5))))
    made = row("r", 4, layers_sha256="1a" * 32)
    shell.tell(RendersSeen(at(0.6), (made,), {}, 1))
    followed = shell.tell(Tick(at(0.7)))
    assert "WriteImage" in kinds(followed)
    assert "EndRender" in kinds(followed)


def test_what_is_not_committed_is_not_acknowledged() -> None:
    shell = Shell((row("r"),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    shell.result("r", 0.2)
    shell.answers[do.Commit] = lambda _: StoreUnavailable("disk full")
    assert kinds(shell.tell(Tick(at(0.5)))) == ["Commit"]
    # No new jobs until one works.
    shell.result("r", 0.6, index=1)
    assert shell.tell(StreamIsReady(at(0.7))) == []
    shell.answers[do.Commit] = lambda _: CommitDone(shell.now, ())
    assert kinds(shell.tell(Tick(at(1.5))))[:2] == ["Commit", "Acknowledge"]


def test_a_render_that_a_commit_finds_lost_is_left_to_its_new_owner() -> None:
    shell = Shell((row("r"),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    shell.result("r", 0.2)
    shell.answers[do.Commit] = lambda _: CommitDone(shell.now, ("r",))
    shell.answers[do.IsOpen] = lambda _: True
    # Neither its jobs nor its results are touched.
    assert kinds(shell.tell(Tick(at(0.5)))) == ["Commit", "IsOpen", "RefreshRenders", "ReleaseLease"]
    assert shell.core.state.renders == {}


@pytest.mark.parametrize("trouble", [LeaseLost("r"), StoreUnavailable("gone")])
def test_a_render_that_can_not_be_started_is_looked_at_again(trouble: Exception) -> None:
    shell = Shell((row("r"),))
    shell.answers[do.StartRender] = lambda _: trouble
    assert kinds(shell.take_up())[-1] == "RefreshRenders"
    assert shell.core.state.renders == {}


def test_an_extended_render_goes_on_where_it_stands() -> None:
    """Its jobs stay out, and a result that waits for an earlier one still does."""
    shell = Shell((row("r"),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    assert shell.result("r", 0.2, index=1) == []
    longer = replace(row("r", 64), state=RenderState.RUNNING)
    assert kinds(shell.tell(RendersSeen(at(0.3), (longer,), {}, 1))) == ["PublishExclusions"]
    render = shell.core.state.renders["r"]
    assert list(render.planned.schedule.range_ends) == [4, 8, 16, 32, 64]
    shell.result("r", 0.4)
    assert render.film.manifest() == [8, 0]
    keys = [key for each in shell.tell(StreamIsReady(at(0.5))) for key in getattr(each, "keys", ())]
    assert JobKey("r", 0, 2) in keys
    assert JobKey("r", 1, 0) not in keys, "it is out already"


def test_a_cut_withdraws_only_what_is_cut() -> None:
    """And a result that waits and is of a range that is no more is settled."""
    shell = Shell((row("r", 64),))
    shell.answers[do.Recut] = lambda _: True
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    shell.result("r", 0.2, index=3)
    render = shell.core.state.renders["r"]
    assert render.film.queues[0].waiting.keys() == {3}
    # A range of 16 samples would take 160 s.
    render._longest[False] = 4
    followed = shell.tell(Tick(at(0.3)))
    assert kinds(followed)[:2] == ["Recut", "Withdraw"]
    ends = list(render.planned.schedule.range_ends)
    assert ends == [4, 8, 12, 16, *range(20, 65, 4)]
    assert render.film.queues[0].waiting == {}
    scheduler = shell.core.state.scheduler
    states = [[scheduler.state_of(JobKey("r", tile, index)) for index in range(3)] for tile in (0, 1)]
    out, planned = RangeState.PUBLISHED, RangeState.PLANNED
    assert states == [[out, out, planned], [out, out, planned]]
    for index in range(len(ends)):
        shell.tell(StreamIsReady(at(0.4)))
        shell.result("r", 0.4, 0, index)
    assert render.film.manifest() == [64, 0]


def test_a_schedule_without_the_merged_ranges_is_taken_up_anew() -> None:
    shell = Shell((row("r", 8),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    shell.result("r", 0.2)
    other = replace(row("r", 8), schedule=make_schedule(33, 2, 3), state=RenderState.RUNNING)
    followed = kinds(shell.tell(RendersSeen(at(0.3), (other,), {}, 1)))
    assert "TakeRender" in followed


def test_jobs_whose_publication_failed_are_published_again() -> None:
    shell = Shell((row("r"),))
    shell.take_up()
    shell.answers[do.Publish] = lambda _: QueueError("no answer")
    first = shell.tell(StreamIsReady(at(0.1)))
    del shell.answers[do.Publish]
    shell.answers[do.Publish] = lambda asked: [shell.entry() for _ in asked.jobs]
    again = shell.tell(StreamIsReady(at(0.2)))
    assert [each.keys for each in again if isinstance(each, do.Publish)] == [
        each.keys for each in first if isinstance(each, do.Publish)
    ]


def test_jobs_that_are_there_are_adopted_and_others_withdrawn() -> None:
    shell = Shell((row("r"),))
    shell.take_up()
    planned = shell.core.state.renders["r"].planned
    job = planned.job(1, planned.ranges[0]).SerializeToString()
    foreign = job_pb2.Job(render_id="elsewhere").SerializeToString()
    followed = shell.tell(
        JobsFound(at(0.1), ((b"1-1", job), (b"1-2", job), (b"1-3", b"\xff"), (b"1-4", foreign)))
    )
    assert followed == [
        do.IsOpen("elsewhere"),
        do.Withdraw((b"1-2",)),
        do.Withdraw((b"1-3", b"1-4"), stop=True),
    ]
    (published,) = shell.tell(StreamIsReady(at(0.2)))
    assert isinstance(published, do.Publish)
    assert ("r", 1, 0) not in published.keys
    shell.tell(RedisEmptied(at(0.3)))
    (published,) = shell.tell(StreamIsReady(at(0.4)))
    assert isinstance(published, do.Publish)
    assert ("r", 1, 0) in published.keys


def test_a_result_that_is_read_again_while_it_waits_is_not_deleted() -> None:
    """Found by random orders of faults: the stream is read from its start after Redis was emptied."""
    shell = Shell((row("r"),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    planned = shell.core.state.renders["r"].planned
    data = simulated_result(planned.job(0, planned.ranges[1])).SerializeToString()
    for now in (0.2, 0.3):
        shell.tell(ResultCame(at(now), b"7-0", data, 0.99))
    shell.result("r", 0.4, tile=1)
    followed = shell.tell(Tick(at(0.5)))
    assert b"7-0" not in [
        entry for each in followed if isinstance(each, do.Acknowledge) for entry in each.entries
    ]
    # The one that it waited for comes: both are merged.
    shell.result("r", 0.6)
    followed = shell.tell(Tick(at(1.1)))
    assert b"7-0" in [
        entry for each in followed if isinstance(each, do.Acknowledge) for entry in each.entries
    ]


def test_a_render_that_goes_on_has_no_image_written() -> None:
    """The API makes an image of the committed samples on request."""
    shell = Shell((row("r", 3000),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    shell.result("r", 0.2)
    written = kinds(shell.tell(Tick(at(3600.0))))
    assert "WritePreview" in written
    assert "WriteImage" not in written


@pytest.mark.parametrize(("renders", "pause"), [(1, 10.0), (2, 10.0), (6, 30.0)])
def test_previews_of_many_renders_cost_no_more_than_those_of_two(renders: int, pause: float) -> None:
    """One that takes 0.1 s is a hundredth of ten seconds."""
    shell = Shell(tuple(row(f"{number}", 3000) for number in range(renders)))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    shell.answers[do.WritePreview] = lambda _: at(shell.now.now + 0.1)
    for number in range(renders):
        shell.result(f"{number}", 0.2)

    def previews(now: float) -> int:
        for render in shell.core.state.renders.values():
            # As if new samples had come.
            render.pictured_photons = 0
        return kinds(shell.tell(Tick(at(now)))).count("WritePreview")

    assert previews(1.0) == renders
    assert previews(0.9 + pause) == 0
    assert previews(2.0 + pause) == renders


def test_results_are_merged_between_pictures_of_many_renders() -> None:
    """Each takes 0.6 s: all at once, they would keep results of everybody for five seconds."""
    shell = Shell(tuple(row(f"{number}", 3000) for number in range(8)))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))

    def takes_long(_: do.Instruction) -> Moment:
        shell.now = at(shell.now.now + 0.6)
        return shell.now

    shell.answers[do.WritePreview] = takes_long
    for number in range(8):
        shell.result(f"{number}", 0.2)

    def shown(now: float) -> list[str]:
        return [each.render_id for each in shell.tell(Tick(at(now))) if isinstance(each, do.WritePreview)]

    assert [shown(0.5 + 2.0 * turn) for turn in range(8)] == [[f"{number}"] for number in range(8)]


def test_a_large_film_is_looked_at_by_a_process_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """The render is not held up while that works, and says of its end what the last pictures show."""
    large = row("large", stop=StopConditions(wall_seconds=100.0))
    shell = Shell((replace(large, schedule=make_schedule(2048, 1025, 3000)),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    made: list[PicturesMade | None] = [None]
    shell.answers[do.MakePictures] = lambda _: made[0]
    wanted = (do.MakePictures, do.WritePreview, do.WriteThumbnail, do.WriteImage, do.RecordError)

    def shown(now: float) -> list[do.Instruction]:
        return [each for each in shell.tell(Tick(at(now))) if isinstance(each, wanted)]

    monkeypatch.setattr(MergedFilm, "estimate", _no_time)
    asked = do.MakePictures("large", final=False)
    shell.result("large", 0.2)
    assert shown(0.5) == [asked]
    shell.result("large", 0.6, tile=1)
    assert shown(1.1) == [asked]
    estimate = ErrorEstimate(0.02, 5.0, 0.01, pixels=2048 * 1025, samples=100)
    point = ErrorPoint(1.7e9, 1024, 100.0, 0.02, mean=5.0)
    made[0] = PicturesMade(at(2.0), MadeApart(point, estimate, 0.4))
    assert shown(2.0)[0] == asked
    assert shell.core.state.renders["large"].estimate == estimate
    # It took a fiftieth of twenty seconds.
    shell.result("large", 2.1, tile=2)
    assert (shown(21.0), shown(22.5)[:1]) == ([], [asked])
    made[0] = PicturesMade(at(101.0), MadeApart(replace(point, photons=4096), estimate, 0.4))
    last = shown(101.0)
    assert [type(each) for each in last[-3:]] == [do.MakePictures, do.WriteImage, do.RecordError]
    assert last[-3] == do.MakePictures("large")


def _no_time(_: MergedFilm) -> ErrorEstimate:
    raise AssertionError("the film is too large to look at while results wait")


def test_a_state_that_must_not_be_is_found() -> None:
    shell = Shell((row("r"),))
    shell.take_up()
    shell.tell(StreamIsReady(at(0.1)))
    render = shell.core.state.renders["r"]
    render.totals.photons += 1
    with pytest.raises(InvalidState, match="photons"):
        shell.core.validate_state()
    render.totals.photons -= 1
    shell.core.state.scheduler._outstanding.clear()
    with pytest.raises(InvalidState, match="by other entries"):
        shell.core.validate_state()


def test_committed_tiles_that_do_not_fit_fail_the_render() -> None:
    shell = Shell((row("r"),))
    shell.answers[do.ReadTiles] = lambda _: [TileRow(0, 5, b"")]
    followed = shell.take_up()
    assert [each.state for each in followed if isinstance(each, do.EndRender)] == [RenderState.FAILED]
    assert shell.core.state.renders == {}
