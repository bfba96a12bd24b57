"""Children of `nocturne up` that are there and do nothing."""

import os
import signal
import sys
import time
from contextlib import closing
from pathlib import Path

import pytest
from nocturne_client import Client
from nocturne_client.local.children import Child
from nocturne_client.local.probes import redis_answers, worker_is_heard_of
from nocturne_coordinator.queue import keys

from tests.coordinator.service import RedisServer
from tests.system.program import is_running
from tests.system.renders import CORNELL
from tests.system.up import Up
from tests.system.waiting import LIMIT_S, wait_for

SLEEPS = (sys.executable, "-c", "import time; time.sleep(60)")


def test_a_child_that_does_not_answer_is_started_again(tmp_path: Path) -> None:
    """P13: after a time without an answer, with a sentence; one that answers is left alone."""
    said: list[str] = []
    answering, hanging = (
        Child(name, SLEEPS, tmp_path / name, lambda name=name: name == "well", silent_s=3.0, loads_s=3.0)  # type: ignore[misc]
        for name in ("well", "hanging")
    )
    answering.start()
    hanging.start()
    try:
        before = answering.pid, hanging.pid
        end = time.monotonic() + LIMIT_S
        while hanging.pid in (0, before[1]) and time.monotonic() < end:
            answering.supervise(said.append)
            hanging.supervise(said.append)
            time.sleep(0.05)
        assert answering.pid == before[0]
        assert hanging.pid not in (0, before[1])
        assert not is_running(before[1])
        assert said[0].startswith("hanging has not answered for 3 s; ending it.")
    finally:
        answering.stop(1.0)
        hanging.stop(1.0)


def test_redis_is_asked_too(redis_server: RedisServer) -> None:
    """P13: one that stands still answers nothing; a worker that can't tell it anything is not blamed."""
    socket = Path(redis_server.url.removeprefix("unix://"))
    client = redis_server.client()
    client.set(keys.WORKER_PREFIX + "here", b"status")
    assert redis_answers(socket)
    assert worker_is_heard_of(socket, "here")
    assert not worker_is_heard_of(socket, "gone")
    pid = int(client.info("server")["process_id"])
    os.kill(pid, signal.SIGSTOP)
    try:
        assert not redis_answers(socket)
        assert worker_is_heard_of(socket, "gone")
    finally:
        os.kill(pid, signal.SIGCONT)
    client.close()


def test_a_child_may_take_longer_for_its_first_answer(tmp_path: Path) -> None:
    """On a machine that is full a program loads for longer than it may be silent for later."""
    answers = False
    child = Child("slow", SLEEPS, tmp_path / "slow", lambda: answers, silent_s=0.2, loads_s=30.0)
    child.start()
    try:
        before = child.pid
        time.sleep(2.0)
        child.supervise(print)
        assert child.pid == before
        answers = True
        time.sleep(2.0)
        answers = False
        wait_for(lambda: child.supervise(print), "it to be started again", LIMIT_S)
        assert child.pid not in (0, before)
    finally:
        child.stop(1.0)


@pytest.mark.system
def test_hung_children_are_started_again_and_work_goes_on(tmp_path_factory: pytest.TempPathFactory) -> None:
    """P13: all but Redis stand still; soon others are there, and a render comes to its end."""
    with Up(tmp_path_factory.mktemp("hung")) as service:
        _render(service)
        before = {name: pid for name, pid in service.children().items() if name != "redis"}
        for pid in before.values():
            os.kill(pid, signal.SIGSTOP)
        wait_for(
            lambda: not set(service.children().values()) & {0, *before.values()}, "others to be there", 150.0
        )
        assert not any(is_running(pid) for pid in before.values())
        said = service.program.log.read_text()
        assert all(f"{name} has not answered for" in said for name in before)
        service.wait_until_up()
        _render(service)


def _render(service: Up) -> None:
    with closing(Client(service.url)) as client:
        render = client.submit(CORNELL, 40, 30, 16)
        wait_for(lambda: client.get(render.id).has_ended, "the render to end")
        assert client.get(render.id).state == "SUCCEEDED"
