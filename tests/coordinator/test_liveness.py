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
    assert faults.failed(key(1), "a", "x", live, 0.0) is None
    assert faults.failed(key(1), "a", "x", live, 0.0) is None
    assert faults.failed(key(1), "b", "y", live, 0.0) is None
    verdict = faults.failed(key(1), "c", "z", live, 0.0)
    assert verdict is not None
    assert (verdict.reason, verdict.workers) == ("z", ("a", "b", "c"))


def test_where_nobody_else_is_three_attempts_condemn_a_job() -> None:
    faults = FailurePolicy()
    for _ in range(2):
        assert faults.failed(key(1), "a", "x", {"a"}, 0.0) is None
    assert faults.failed(key(1), "a", "x", {"a", "b"}, 0.0) is None
    assert faults.failed(key(1), "b", "x", {"a", "b"}, 0.0) is not None


def test_before_anybody_is_known_to_work_nobody_condemns_a_job() -> None:
    faults = FailurePolicy()
    for _ in range(5):
        assert faults.failed(key(1), "a", "x", set(), 0.0) is None
        assert faults.failed(key(1), "a", "x", {"b"}, 0.0) is None
    assert faults.succeeded(key(1), "b", 0.0) == []


def test_three_jobs_that_others_can_do_condemn_a_worker() -> None:
    faults = FailurePolicy()
    for number in range(5):
        faults.failed(key(number), "a", "x", {"a", "b", "c"}, 0.0)
    assert faults.succeeded(key(0), "b", 0.0) == []
    assert faults.succeeded(key(1), "b", 0.0) == []
    # A job that the worker itself completes on its second attempt counts in its favour.
    assert faults.succeeded(key(2), "a", 0.0) == []
    assert faults.succeeded(key(3), "c", 0.0) == ["a"]


def test_a_scene_that_fails_everywhere_condemns_nobody() -> None:
    faults = FailurePolicy()
    chance = random.Random(1)
    for _ in range(300):
        faults.failed(key(chance.randrange(50)), chance.choice("abc"), "x", {"a", "b", "c"}, 0.0)
    assert faults.succeeded(key(99), "a", 0.0) == []
    faults.forget("r")
    assert [faults.succeeded(key(number), "d", 0.0) for number in range(50)] == [[]] * 50


def test_three_deaths_condemn_a_job_where_deaths_are_rare() -> None:
    faults, live = FailurePolicy(), {f"{number}" for number in range(40)}
    for number in range(1000):
        faults.succeeded(key(number), "0", 0.0)
    verdicts = [faults.failed(key(1), worker, "died of it", live, 0.0, died=True) for worker in "123"]
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
                verdict = faults.failed(key(number), worker, "died of it", workers, 0.75 * number, died=True)
                assert verdict is None
                worker = chance.choice(workers)
            assert faults.succeeded(key(number), worker, 0.75 * number) == []


def test_failures_of_long_ago_count_no_more() -> None:
    """Three failures among 300,000 jobs that went well, a day apart: everybody fails at times."""
    faults = FailurePolicy()
    for day in range(3):
        at = 86400.0 * day
        faults.failed(key(day), "a", "the network is down", {"a", "b"}, at)
        assert faults.succeeded(key(day), "b", at + 1.0) == []
        for number in range(100_000):
            faults.succeeded(key(1000 + number), "a", at + 0.8 * number)
    # Three within an hour, of which one is of a render that is over by then.
    at += 86400.0
    for number in range(3):
        faults.failed(key(number), "a", "the disk is full", {"a", "b"}, at + 1000.0 * number)
        guilty = faults.succeeded(key(number), "b", at + 1000.0 * number + 1.0)
        faults.forget("r")
    assert guilty == ["a"]


def test_in_a_storm_of_deaths_after_quiet_weeks_four_of_them_condemn_no_job() -> None:
    """Workers are taken away by hundreds, as by a provider who wants them back: some jobs are hit again and
    again. A coordinator that has worked for weeks sees that as one does that has just started."""
    faults, live = FailurePolicy(), {f"{number}" for number in range(40)}
    for number in range(1_000_000):
        faults.succeeded(key(number), "0", number / 16.0)
    for number in range(200):
        faults.failed(key(number), f"gone-{number}", "died of it", live, 62_500.0, died=True)
    verdicts = [faults.failed(key(-1), each, "died of it", live, 62_505.0, died=True) for each in "1234"]
    assert verdicts == [None] * 4
    # An hour later, with nothing but good jobs, three are enough again.
    for number in range(60_000):
        faults.succeeded(key(number), "0", 62_510.0 + number / 16.0)
    verdicts = [faults.failed(key(-2), each, "died of it", live, 66_300.0, died=True) for each in "123"]
    assert [verdict is not None for verdict in verdicts] == [False, False, True]


def test_a_worker_that_dies_of_every_job_is_condemned() -> None:
    faults, live = FailurePolicy(), {f"{number}" for number in range(40)}
    guilty: list[str] = []
    deaths = 0
    for number in range(1000):
        if number % 10 == 0:
            faults.failed(key(number), "7", "died of it", live, 0.0, died=True)
            deaths += 1
        guilty = faults.succeeded(key(number), "1", 0.0)
        if guilty:
            break
    assert guilty == ["7"]
    assert deaths <= 8
