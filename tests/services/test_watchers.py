"""The poller that tells watchers, on a data folder that the test plays: whose streams end, and when."""

import asyncio
from collections.abc import Callable, Set

import pytest
from nocturne_api.access import Caller
from nocturne_api.errors import Unauthenticated
from nocturne_api.models.renders import Render
from nocturne_api.operations.watchers import Watcher, Watchers

from tests.system.waiting import LIMIT_S

EVE, ALICE = (Caller(name, frozenset({"read"}), sees_all=True) for name in ("eve", "alice"))


class Folder:
    """What a poller asks, as attributes."""

    def __init__(self) -> None:
        self.counter = 1
        self.looked = asyncio.Event()
        self.looks = 0
        self.gone: set[str] = set()
        self.renders: list[Render] = []
        self.before_a_look: Callable[[], None] = lambda: None

    async def change_counter(self) -> int:
        return self.counter

    async def get(self, render_id: str) -> Render | None:  # noqa: ARG002 - nobody asks
        return None

    async def newest(self, owner: str | None) -> list[Render]:  # noqa: ARG002 - all see all
        self.before_a_look()
        self.looks += 1
        self.looked.set()
        return self.renders

    async def revoked(self, names: Set[str]) -> Set[str]:
        return names & self.gone


async def reads(watcher: Watcher) -> str:
    """The next render's id."""
    async with asyncio.timeout(LIMIT_S):
        found = await watcher.next()
    assert found is not None
    return found.id


async def is_shut(watcher: Watcher) -> bool:
    """Whether the next that comes is the end."""
    try:
        await reads(watcher)
    except Unauthenticated:
        return True
    return False


async def test_who_is_revoked_waits_for_no_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """P10: after a slow look at the folder watchers pause for a while; a revocation ends them at once."""
    monkeypatch.setattr("nocturne_api.operations.watchers.WATCH_REST", 1e12)
    folder = Folder()
    watchers = Watchers(folder)
    with watchers.watching(None, EVE) as eve:
        await folder.looked.wait()
        folder.gone.add("eve")
        folder.counter += 1
        assert await is_shut(eve)
        assert folder.looks == 1
    await watchers.close()


async def test_nobody_hears_of_what_came_after_its_token_was_revoked() -> None:
    """P10: not even where both come while states are read."""
    folder = Folder()

    def revoke_and_submit() -> None:
        folder.gone.add("eve")
        folder.renders = [Render.model_construct(id="after it", sequence=1)]

    folder.before_a_look = revoke_and_submit
    watchers = Watchers(folder)
    with watchers.watching(None, EVE) as eve, watchers.watching(None, ALICE) as alice:
        assert await is_shut(eve)
        assert await reads(alice) == "after it"
    await watchers.close()


async def test_who_rests_tells_what_came_meanwhile(monkeypatch: pytest.MonkeyPatch) -> None:
    """Once the rest is over, without a further change."""
    monkeypatch.setattr("nocturne_api.operations.watchers.WATCH_REST", 100.0)
    folder = Folder()
    watchers = Watchers(folder)
    with watchers.watching(None, ALICE) as alice:
        await folder.looked.wait()
        folder.renders = [Render.model_construct(id="meanwhile", sequence=1)]
        folder.counter += 1
        assert await reads(alice) == "meanwhile"
    await watchers.close()
