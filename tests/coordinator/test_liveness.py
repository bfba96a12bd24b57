"""Who died with a job in hand, and who only left, dawdled or was out of sight."""

import random

from nocturne_coordinator.dispatch.failure_policy import FailurePolicy
from nocturne_coordinator.dispatch.liveness import Holder, Liveness, Sign
from nocturne_coordinator.dispatch.scheduler import JobKey

KEY = JobKey("r", 3, 1)
ENTRIES = {b"1-0": KEY}
FRESH, STALE = 9000, 3000


def seen(*looks: tuple[dict[str, Sign], list[Holder]]) -> list[tuple[JobKey, str]]:
    lives = Liveness()
    return [lost for signs, holders in looks for lost in lives.look(signs, holders, ENTRIES)]


def test_a_status_that_runs_out_is_a_death() -> None:
    held = [Holder(b"1-0", "a")]
    assert seen(({"a": Sign(1.0, FRESH)}, held), ({"a": Sign(1.0, STALE)}, held), ({}, held)) == [(KEY, "a")]


def test_a_farewell_is_none() -> None:
    held = [Holder(b"1-0", "a")]
    assert seen(({"a": Sign(1.0, FRESH)}, held), ({}, held), ({}, held)) == []


def test_a_slow_worker_is_alive() -> None:
    held = [Holder(b"1-0", "a")]
    assert (
        seen(
            ({"a": Sign(1.0, FRESH)}, held), ({"a": Sign(1.0, STALE)}, held), ({"a": Sign(1.0, FRESH)}, held)
        )
        == []
    )


def test_a_new_process_of_the_same_name_is_a_death() -> None:
    held = [Holder(b"1-0", "a")]
    assert seen(({"a": Sign(1.0, FRESH)}, held), ({"a": Sign(2.0, FRESH)}, held)) == [(KEY, "a")]


def test_a_job_taken_over_before_the_death_shows_is_not_forgotten() -> None:
    a, b = {"a": Sign(1.0, STALE), "b": Sign(1.0, FRESH)}, {"b": Sign(1.0, FRESH)}
    assert seen((a, [Holder(b"1-0", "a")]), (a, [Holder(b"1-0", "b")]), (b, [Holder(b"1-0", "b")])) == [
        (KEY, "a")
    ]


def test_a_job_done_elsewhere_is_nobodys_death() -> None:
    assert (
        seen(({"a": Sign(1.0, STALE)}, [Holder(b"1-0", "a")]), ({"a": Sign(1.0, STALE)}, []), ({}, [])) == []
    )


def key(number: int) -> JobKey:
    return JobKey("r", number, 0)


def test_three_workers_condemn_a_job() -> None:
    faults = FailurePolicy()
    live = {"a", "b", "c", "d"}
    assert faults.failed(key(1), "a", "x", live) is None
    assert faults.failed(key(1), "a", "x", live) is None
    assert faults.failed(key(1), "b", "y", live) is None
    verdict = faults.failed(key(1), "c", "z", live)
    assert verdict is not None
    assert (verdict.reason, verdict.workers) == ("z", ("a", "b", "c"))


def test_where_nobody_else_is_three_attempts_condemn_a_job() -> None:
    faults = FailurePolicy()
    for _ in range(2):
        assert faults.failed(key(1), "a", "x", {"a"}) is None
    assert faults.failed(key(1), "a", "x", {"a", "b"}) is None
    assert faults.failed(key(1), "b", "x", {"a", "b"}) is not None


def test_before_anybody_is_known_to_work_nobody_condemns_a_job() -> None:
    faults = FailurePolicy()
    for _ in range(5):
        assert faults.failed(key(1), "a", "x", set()) is None
        assert faults.failed(key(1), "a", "x", {"b"}) is None
    assert faults.succeeded(key(1), "b") == []


def test_three_jobs_that_others_can_do_condemn_a_worker() -> None:
    faults = FailurePolicy()
    for number in range(5):
        faults.failed(key(number), "a", "x", {"a", "b", "c"})
    assert faults.succeeded(key(0), "b") == []
    assert faults.succeeded(key(1), "b") == []
    # A job that the worker itself completes on its second attempt counts in its favour.
    assert faults.succeeded(key(2), "a") == []
    assert faults.succeeded(key(3), "c") == ["a"]


def test_a_scene_that_fails_everywhere_condemns_nobody() -> None:
    faults = FailurePolicy()
    chance = random.Random(1)
    for _ in range(300):
        faults.failed(key(chance.randrange(50)), chance.choice("abc"), "x", {"a", "b", "c"})
    assert faults.succeeded(key(99), "a") == []
    faults.forget("r")
    assert [faults.succeeded(key(number), "d") for number in range(50)] == [[]] * 50


def test_three_deaths_condemn_a_job_where_deaths_are_rare() -> None:
    faults, live = FailurePolicy(), {f"{number}" for number in range(40)}
    for number in range(1000):
        faults.succeeded(key(number), "0")
    verdicts = [faults.failed(key(1), worker, "died of it", live, died=True) for worker in "123"]
    assert [verdict is not None for verdict in verdicts] == [False, False, True]


def test_a_night_of_pulled_plugs_condemns_nobody() -> None:
    """Forty workers, ten hours, jobs of 30 s, each worker killed every ten minutes: one job in 20 ends so.

    By chance, a job or a worker would be condemned in one night of 700, so in this test, with other seeds, in
    one run of 30. With three deaths each it would be some six jobs a night.
    """
    for seed in range(20):
        chance, faults = random.Random(seed), FailurePolicy()
        workers = [f"{number}" for number in range(40)]
        for number in range(40 * 1200):
            worker = chance.choice(workers)
            while chance.random() < 0.05:
                assert faults.failed(key(number), worker, "died of it", workers, died=True) is None
                worker = chance.choice(workers)
            assert faults.succeeded(key(number), worker) == []


def test_a_worker_that_dies_of_every_job_is_condemned() -> None:
    faults, live = FailurePolicy(), {f"{number}" for number in range(40)}
    guilty: list[str] = []
    deaths = 0
    for number in range(1000):
        if number % 10 == 0:
            faults.failed(key(number), "7", "died of it", live, died=True)
            deaths += 1
        guilty = faults.succeeded(key(number), "1")
        if guilty:
            break
    assert guilty == ["7"]
    assert deaths <= 8
