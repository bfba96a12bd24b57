"""Renders and their groups: creating, reading and deleting."""

import asyncio
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial

from nocturne_coordinator.errors import BlobsMissing
from nocturne_coordinator.limits import MAX_PAGE
from nocturne_coordinator.store.groups import Groups as GroupRows
from nocturne_coordinator.store.quotas import Quota, check_quota
from nocturne_coordinator.store.removal import delete_render
from nocturne_coordinator.store.rows import RenderRow
from nocturne_coordinator.traces import Traces
from nocturne_scene.errors import NotFound

from nocturne_api import limits
from nocturne_api.access import CALLER
from nocturne_api.background.garbage_collector import GarbageCollector
from nocturne_api.background.layer_builder import LayerBuilder
from nocturne_api.background.space import DiskQuota
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.compiling.turns import CompileTurns
from nocturne_api.errors import Overloaded, RateLimited
from nocturne_api.models.render_requests import CreateGroupRequest, CreateRenderRequest
from nocturne_api.models.renders import (
    Baselines,
    Convergence,
    ConvergencePoint,
    Explanation,
    Group,
    NewGroup,
    Render,
    RenderPage,
    TileInProgress,
    TilesInProgress,
)
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.group_members import Member, Members
from nocturne_api.operations.status_reason import sentence, situation_of
from nocturne_api.operations.submission import compiled_member, raise_if, request_id_problems
from nocturne_api.places import until_abandoned


class Renders:
    """The renders of one data folder. All but deleting take the beginning of an id for the id."""

    def __init__(
        self,
        access: FolderAccess,
        compile_limits: CompileLimits,
        garbage_collector: GarbageCollector,
        space: DiskQuota,
        layer_builder: LayerBuilder,
        traces: Traces,
    ) -> None:
        self._traces = traces
        self._access = access
        self._space = space
        self._compile_limits = compile_limits
        self._sweeper = garbage_collector
        self._layers_maker = layer_builder
        self._compiling = CompileTurns()
        self._waiting: Counter[str] = Counter()

    async def create(self, request: CreateRenderRequest) -> Render:
        """Makes a render, or gives back the one made before with this request id.

        Raises InputError with every problem found, Conflict where the caller used the request id for another,
        QuotaUsedUp or FolderFull where it or all would have too much, Overloaded or RateLimited where too
        many scenes wait to be compiled. A failed call leaves nothing behind."""
        [created] = await self._create(request)
        return created

    async def create_group(self, request: CreateGroupRequest) -> NewGroup:
        """Makes all renders of a group, or none; gives back those made before with this request id.

        Raises as `create`; a problem names the render that has it.
        """
        renders = await self._create(request)
        return NewGroup(name=renders[0].group, renders=[*renders])

    async def _create(self, request: CreateRenderRequest) -> Sequence[Render]:
        begun = time.time()
        async with self._access.recorded("create", request_id=request.request_id) as record:
            CALLER.get().need("submit")
            self._space.check()
            owner, quota = CALLER.get().name, self._access.quota
            members: Members | Sequence[Member] = [Member("", request.request_id, {})]
            if isinstance(request, CreateGroupRequest):
                members = await asyncio.to_thread(Members, request)
                request = members.asked
            await self._access.in_database(self._check_quota, next(iter(members)), len(members), owner, quota)
            with self._waiting_for_compiler():
                created = await self._compiled_and_created(request, members, owner)
            record.render_id = created[0].id
            for each in created:
                # One that was made before has its span.
                if each.created >= begun:
                    about: dict[str, str | int] = {
                        "nocturne.owner": owner,
                        "nocturne.ranges": each.ranges_planned,
                    }
                    self._traces.submitted(each.id, begun, about)
            if created[0].layers:
                self._layers_maker.wake()
            return [Render.of(row) for row in created]

    async def get(self, render_id: str) -> Render:
        """The render with this id, or whose id alone begins so, among those that the caller may see.

        Raises NotFound, AmbiguousId.
        """
        CALLER.get().need("read")
        caller = CALLER.get()
        return Render.of(
            await self._access.in_database(self._access.folder.renders.find, render_id, caller.sees)
        )

    async def list(
        self, page_size: int = 0, page_token: str = "", group: str = "", tag: str = "", search: str = ""
    ) -> RenderPage:
        """One page of the renders that the caller may see, newest first; of one group, with a tag, or with
        all words of a search in name, id, owner, state, group or tags, where these are given. A size of 0
        means 50, at most 200 come. Raises InputError."""
        caller = CALLER.get()
        caller.need("read")
        rows, next_token = await self._access.in_database(
            self._access.folder.renders.page, page_size, page_token, caller.sees, group, tag, search
        )
        return RenderPage(renders=[Render.of(row) for row in rows], next_page_token=next_token)

    async def newest(self, owner: str | None) -> Sequence[Render]:
        """The newest renders of an owner, or of everybody, whoever asks."""
        rows, _ = await self._access.in_database(self._access.folder.renders.page, MAX_PAGE, "", owner)
        return [Render.of(row) for row in rows]

    async def delete(self, render_id: str, request_id: str = "") -> None:
        """Forgets a render that has ended, with its images and whatever files no other render uses.

        By its whole id: asked twice, the beginning of an id could mean two renders, one after the other.
        Raises NotFound, also the second time, and WrongState for one that has not ended.
        """
        async with self._access.changing("delete", render_id, request_id) as whole_id:
            if whole_id != render_id:
                raise NotFound(f"there is no render {render_id!r}; deleting takes the whole id")
            await asyncio.to_thread(delete_render, self._access.folder, render_id)
            await self._sweeper.sweep()

    async def replay(self, render_id: str, request_id: str) -> Render:
        """A new render with the samples per tile that this one has: the same bits. NotFound, Conflict."""
        access = self._access
        async with access.recorded("replay", render_id, request_id):
            CALLER.get().need("submit")
            self._space.check()
            raise_if(request_id_problems(request_id))
            owner = CALLER.get().name
            whole_id = (await access.in_database(access.folder.renders.find, render_id, CALLER.get().sees)).id
            return Render.of(
                await access.writing(access.folder.requests.replay, whole_id, request_id, owner, access.quota)
            )

    async def baselines(self, render_id: str) -> Baselines:
        """Renders of the same scene and film by other engines, to be compared; raises NotFound."""
        whole_id = (await self.get(render_id)).id
        rows = await self._access.in_database(
            self._access.folder.renders.baselines, whole_id, CALLER.get().sees
        )
        return Baselines(renders=[Render.of(row) for row in rows])

    async def explain(self, render_id: str) -> Explanation:
        """What the render waits for, in one sentence; raises NotFound."""
        whole_id = (await self.get(render_id)).id
        situation = await self._access.in_database(situation_of, self._access.folder, whole_id)
        return Explanation(sentence=sentence(situation, time.time()))

    async def convergence(self, render_id: str) -> Convergence:
        """The error estimate at every preview so far; raises NotFound."""
        render = await self.get(render_id)
        history = await self._access.in_database(self._access.folder.renders.error_history, render.id)
        points = [
            ConvergencePoint(
                time_s=max(0.0, point.unix_time - (render.started or render.created)),
                samples=point.samples,
                relative_error=point.relative_error,
                top_percent_share=point.top_percent_share,
                effective_pixels=point.effective_pixels,
            )
            for point in history
        ]
        return Convergence(points=points)

    async def tiles_in_progress(self, render_id: str) -> TilesInProgress:
        """Which tiles of a render are being traced, and by whom; raises NotFound."""
        render = await self.get(render_id)
        found = await self._access.in_database(self._access.folder.tiles.at_work, render.id)
        return TilesInProgress(tiles=[TileInProgress(tile=tile, worker=worker) for tile, worker in found])

    def check_room(self) -> None:
        """Raises FolderFull where a new render would find no room, Overloaded where too many wait already."""
        self._space.check()
        if self._waiting.total() >= limits.COMPILES_WAITING:
            raise Overloaded(
                f"{limits.COMPILES_WAITING} scenes are waiting to be compiled; try again in a moment."
            )

    def _check_quota(self, first: Member, renders: int, owner: str, quota: Quota) -> None:
        """Before anything is compiled; a repeated request gets the existing renders."""
        if self._access.folder.renders.find_request(owner, first.request_id) is None:
            check_quota(self._access.folder.database, owner, quota, more_renders=renders)

    async def _compiled_and_created(
        self, request: CreateRenderRequest, members: Members | Sequence[Member], owner: str
    ) -> Sequence[RenderRow]:
        access = self._access
        while True:
            new = []
            for member in members:
                # Members of several groups, and single renders, in turn.
                async with self._compiling.turn(owner):
                    asked = request, member, access.folder, owner, self._compile_limits
                    new.append(await until_abandoned(partial(compiled_member, *asked)))
            # Files that were deleted in between are made again, or found missing by the compiler.
            with suppress(BlobsMissing):
                return await access.writing(access.folder.renders.create_all, new, access.quota)

    @contextmanager
    def _waiting_for_compiler(self) -> Iterator[None]:
        owner = CALLER.get().name
        self.check_room()
        if owner and self._waiting[owner] >= limits.COMPILES_WAITING_OF_OWNER:
            raise RateLimited(
                f"{self._waiting[owner]} scenes of {owner} are being compiled; send them one by one"
            )
        self._waiting[owner] += 1
        try:
            yield
        finally:
            self._waiting[owner] -= 1
            self._waiting += Counter()


class Groups:
    """The groups of one data folder that callers may see."""

    def __init__(self, access: FolderAccess) -> None:
        self._access = access
        self._rows = GroupRows(access.folder.database)

    async def get(self, name: str) -> Group:
        """One group; raises NotFound."""
        caller = CALLER.get()
        caller.need("read")
        return Group.of(await self._access.in_database(self._rows.get, name, caller.sees))
