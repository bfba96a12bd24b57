"""What the service can do, without HTTP or gRPC: both doors call these functions and nothing else."""

import asyncio
import time
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager, suppress
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any, ParamSpec, Self, TypeVar

from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.errors import FilesGone
from nocturne_coordinator.limits import MAX_PAGE
from nocturne_coordinator.store.data_folder import DataFolder, RenderRow
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.removal import delete_render
from nocturne_scene.errors import InputError, NotFound
from nocturne_scene.limits import MAX_RANGES

from nocturne_api import limits, uploads
from nocturne_api.access import CALLER, Caller, caller_of
from nocturne_api.archiver import Archiver
from nocturne_api.compiling.pool import CompileLimits, prepare
from nocturne_api.errors import Overloaded, failure_of
from nocturne_api.metrics import metrics_text
from nocturne_api.open_file import OpenFile, open_file
from nocturne_api.preflight.pool import PreflightSpec, preflight_in_child
from nocturne_api.status_reason import sentence, situation_of
from nocturne_api.submission import (
    CreateRequest,
    checked_stop,
    compiled,
    digest_problems,
    raise_if,
    request_id_problems,
)
from nocturne_api.sweeper import Sweeper
from nocturne_api.tiles import Cursor, TileAnswers, Tiles, encode, runs, tiles_per_answer
from nocturne_api.views import (
    AssetView,
    AtWorkView,
    ConvergencePoint,
    ConvergenceView,
    ExplanationView,
    NewWebhookView,
    PageView,
    RenderView,
    TileAtWork,
    WebhookView,
    WorkerHistoryView,
    WorkerView,
)
from nocturne_api.watching import Watchers, states
from nocturne_api.webhook_sender import WebhookSender
from nocturne_api.webhook_targets import TargetRules

_P = ParamSpec("_P")
_T = TypeVar("_T")


@dataclass
class _Record:
    """What a recorded call was about; the render may be known only in the end."""

    render_id: str


class Operations:
    """The operations on one data folder. Errors are the classes in nocturne_api.errors, whatever the door."""

    def __init__(
        self,
        folder: DataFolder,
        database: ThreadPoolExecutor,
        compile_limits: CompileLimits,
        webhook_rules: TargetRules,
    ) -> None:
        self._folder = folder
        self._compile_limits = compile_limits
        # SQLite calls run one after the other in a thread of their own, never behind compiles or file reads.
        self._database = database
        self._compiling = asyncio.Semaphore(limits.COMPILES_AT_ONCE)
        self._waiting = 0
        self._planning = asyncio.Lock()
        self._watchers = Watchers(self._change_counter, self._find, self._newest)
        self._tile_answers = TileAnswers(self._read_tiles)
        self._webhook_rules = webhook_rules
        self._webhooks = WebhookSender(folder.webhooks, self._in_database, webhook_rules)
        self._webhooks.start()
        objects = folder.object_store
        self._archiver = None if objects is None else Archiver(folder, self._in_database, objects)
        if self._archiver is not None:
            self._archiver.start()
        self._sweeper = Sweeper(folder)
        self._sweeper.start()

    @classmethod
    async def open(
        cls,
        path: Path,
        compile_limits: CompileLimits | None = None,
        webhook_rules: TargetRules | None = None,
        objects: ObjectStore | None = None,
    ) -> Self:
        """Opens the data folder at `path`, making it if need be."""
        database = ThreadPoolExecutor(max_workers=1, thread_name_prefix="data-folder")
        folder = await asyncio.get_running_loop().run_in_executor(database, DataFolder, path, objects)
        prepare()
        return cls(folder, database, compile_limits or CompileLimits(), webhook_rules or TargetRules())

    async def close(self) -> None:
        """Ends all streams and lets go of the data folder."""
        await self._watchers.close()
        await self._webhooks.close()
        if self._archiver is not None:
            await self._archiver.close()
        await self._sweeper.close()
        await self._in_database(self._folder.close)
        self._database.shutdown()

    async def end_streams(self) -> None:
        """Ends all streams, so that doors can close without waiting for watchers."""
        await self._watchers.close()

    # Renders

    async def create_render(self, request: CreateRequest) -> RenderView:
        """Makes a render, or gives back the one made before with this request id.

        Raises InputError with every problem found, Conflict where the request id was used for something
        else, and Overloaded where too many scenes wait to be compiled. A failed call leaves nothing behind.
        """
        async with self._recorded("create", request_id=request.request_id) as record:
            CALLER.get().need("submit")
            async with self._compile_slot():
                owner = CALLER.get().name
                created = await self._compiled_and_created(request, owner)
            record.render_id = created.id
            return RenderView.of(created)

    async def _compiled_and_created(self, request: CreateRequest, owner: str) -> RenderRow:
        while True:
            new = await asyncio.to_thread(compiled, request, self._folder, owner, self._compile_limits)
            # Files that were deleted in between are made again, or found missing by the compiler.
            with suppress(FilesGone):
                return await self._in_database(self._folder.create_render, new)

    async def preflight(self, request: PreflightSpec) -> dict[str, Any]:
        """What a scene needs for a target error; takes minutes.

        Raises InputError with every problem found, CantPreflight, and Overloaded while another preflight
        runs.
        """
        CALLER.get().need("submit")
        if self._planning.locked():
            raise Overloaded("another preflight is running; try again in a few minutes")
        async with self._planning:
            return await preflight_in_child(request, self._folder.blobs, self._compile_limits)

    async def get_render(self, render_id: str) -> RenderView:
        """The render with this id, or whose id alone begins so; raises NotFound, AmbiguousId.

        All operations on a render take the beginning of its id, but for deleting.
        """
        CALLER.get().need("read")
        return RenderView.of(await self._in_database(self._folder.find_render, render_id))

    async def list_renders(self, page_size: int = 0, page_token: str = "") -> PageView:
        """One page of renders, newest first; a size of 0 means 50, at most 200 come. Raises InputError."""
        CALLER.get().need("read")
        rows, next_token = await self._in_database(self._folder.list_renders, page_size, page_token)
        return PageView(renders=[RenderView.of(row) for row in rows], next_page_token=next_token)

    async def cancel_render(self, render_id: str, request_id: str = "") -> RenderView:
        """Stops a render. That is one-way, so repeating the call is safe with or without a request id."""
        async with self._changing("cancel", render_id, request_id) as whole_id:
            if request_id:
                raise_if(request_id_problems(request_id))
            return RenderView.of(await self._in_database(self._folder.request_cancel, whole_id))

    async def delete_render(self, render_id: str, request_id: str = "") -> None:
        """Forgets a render that has ended, with its images and whatever files no other render uses.

        By its whole id: asked twice, the beginning of an id could mean two renders, one after the other.
        Raises NotFound, also the second time, and WrongState for one that has not ended.
        """
        async with self._changing("delete", render_id, request_id) as whole_id:
            if whole_id != render_id:
                raise NotFound(f"there is no render {render_id!r}; deleting takes the whole id")
            await asyncio.to_thread(delete_render, self._folder, render_id)
            await self._sweeper.sweep()

    async def pause_render(self, render_id: str) -> RenderView:
        """No more work until it is resumed; what is merged stays. Raises NotFound, WrongState."""
        async with self._changing("pause", render_id) as whole_id:
            return RenderView.of(await self._in_database(self._folder.request_pause, whole_id))

    async def resume_render(self, render_id: str) -> RenderView:
        """Goes on with a paused render, or traces the failed tiles of a degraded one again. NotFound,
        WrongState."""
        async with self._changing("resume", render_id) as whole_id:
            return RenderView.of(await self._in_database(self._folder.request_resume, whole_id))

    async def set_priority(self, render_id: str, priority: int) -> RenderView:
        """The render's weight among those of its owner, 1 to 1000. Raises NotFound, InputError."""
        async with self._changing("priority", render_id) as whole_id:
            return RenderView.of(await self._in_database(self._folder.request_priority, whole_id, priority))

    async def look_first(self, render_id: str, region: Region | None) -> RenderView:
        """Which part of the film gets its samples first, None for all alike; the image stays the same bits.

        Raises NotFound, InputError.
        """
        async with self._changing("look first", render_id) as whole_id:
            return RenderView.of(await self._in_database(self._folder.request_look_first, whole_id, region))

    async def extend_render(self, render_id: str, samples: int, stop: Mapping[str, Any]) -> RenderView:
        """More samples, 0 for as many as before, and conditions instead of those before.

        Raises NotFound, InputError, WrongState.
        """
        async with self._changing("extend", render_id) as whole_id:
            before = await self._in_database(self._folder.get_render, whole_id)
            checked = checked_stop(stop, before.stop)
            wanted = samples or before.samples
            return RenderView.of(
                await self._in_database(self._folder.request_extension, whole_id, wanted, checked)
            )

    async def replay_render(self, render_id: str, request_id: str) -> RenderView:
        """A new render with the samples per tile that this one has: the same bits. NotFound, Conflict."""
        async with self._recorded("replay", render_id, request_id):
            CALLER.get().need("submit")
            raise_if(request_id_problems(request_id))
            owner = CALLER.get().name
            whole_id = (await self._in_database(self._folder.find_render, render_id)).id
            return RenderView.of(
                await self._in_database(self._folder.create_replay, whole_id, request_id, owner)
            )

    async def explain(self, render_id: str) -> ExplanationView:
        """What the render waits for, in one sentence; raises NotFound."""
        whole_id = (await self.get_render(render_id)).id
        situation = await self._in_database(situation_of, self._folder, whole_id)
        return ExplanationView(sentence=sentence(situation, time.time()))

    async def watch_render(self, render_id: str, last_sequence: int = -1) -> AsyncGenerator[RenderView, None]:
        """The render now and after every change, until it has ended; leaves out states to `last_sequence`."""
        whole_id = (await self.get_render(render_id)).id
        with self._watchers.watching(frozenset({whole_id})) as watcher:
            watcher.already_has(whole_id, last_sequence)
            render = await self.get_render(whole_id)
            watcher.offer(render)
            if render.has_ended and render.sequence <= last_sequence:
                return
            async for state in states(watcher, to_the_end=True):
                yield state

    async def watch_some(self, render_ids: frozenset[str]) -> AsyncGenerator[RenderView, None]:
        """These renders now and after every change, also after their ends. Raises NotFound."""
        whole_ids = frozenset([(await self.get_render(render_id)).id for render_id in render_ids])
        with self._watchers.watching(whole_ids) as watcher:
            for render_id in sorted(whole_ids):
                watcher.offer(await self.get_render(render_id))
            async for state in states(watcher):
                yield state

    async def watch_all(self) -> AsyncGenerator[RenderView, None]:
        """The newest page of renders, then each of them after every change."""
        CALLER.get().need("read")
        with self._watchers.watching(None) as watcher:
            for render in reversed(await self._newest()):
                watcher.offer(render)
            async for state in states(watcher):
                yield state

    async def convergence(self, render_id: str) -> ConvergenceView:
        """The error estimate at every preview so far."""
        render = await self.get_render(render_id)
        history = await self._in_database(self._folder.error_history, render.id)
        return ConvergenceView(
            points=[
                ConvergencePoint(
                    time_s=max(0.0, point.unix_time - (render.started or render.created)),
                    photons=point.photons,
                    samples=point.samples,
                    relative_error=point.relative_error,
                    worst_share=point.worst_share,
                    effective_pixels=point.effective_pixels,
                )
                for point in history
            ]
        )

    # Tiles

    async def tiles(self, render_id: str, since: Cursor) -> Tiles:
        """What of the image changed since; raises NotFound."""
        render = await self.get_render(render_id)
        return await self._tile_answers.get(render.id, since, render.sequence)

    async def changed_tiles(self, render_id: str, since: int) -> list[tuple[int, int]]:
        """First and last indices of the tiles with a revision above `since`."""
        CALLER.get().need("read")
        changes = await self._in_database(
            self._folder.changed_tiles, render_id, (since, MAX_RANGES), MAX_RANGES
        )
        return runs([change.tile_index for change in changes])

    async def _read_tiles(self, render_id: str, since: Cursor) -> Tiles:
        schedule = await self._in_database(self._folder.schedule, render_id)
        most = tiles_per_answer(schedule)
        place = (since.revision, since.tile_index)
        found = await self._in_database(self._folder.tile_sums, render_id, place, most + 1)
        return await asyncio.to_thread(encode, schedule, since, found[:most], len(found) > most)

    # Images

    async def open_thumbnail(self, render_id: str) -> OpenFile:
        """A small tone-mapped PNG for lists; raises NotFound, also before the first."""
        return await self._open_image(render_id, self._folder.thumbnail_path, "thumbnail")

    async def open_preview(self, render_id: str) -> OpenFile:
        """The tone-mapped PNG of what is merged now; raises NotFound, also before the first preview."""
        return await self._open_image(render_id, self._folder.preview_path, "preview")

    async def open_image(self, render_id: str) -> OpenFile:
        """The EXR of what is merged now; raises NotFound, also before the first image."""
        return await self._open_image(render_id, self._folder.image_path, "image")

    # Workers

    async def workers(self) -> list[WorkerView]:
        """Workers heard of in the last ten seconds."""
        CALLER.get().need("read")
        folder = self._folder
        rows, quarantined, incompatible = await self._in_database(
            lambda: (folder.workers(), folder.workers_in_quarantine(), folder.incompatible_workers())
        )
        return [WorkerView.of(row, quarantined.get(row.id, ""), incompatible.get(row.id, "")) for row in rows]

    async def worker_history(self) -> WorkerHistoryView:
        """Who came and went, and what all workers did."""
        CALLER.get().need("read")
        events, rates = await self._in_database(self._folder.worker_history, limits.EVENTS_SHOWN)
        return WorkerHistoryView.model_validate({"events": events, "rates": rates})

    async def at_work(self, render_id: str) -> AtWorkView:
        """Which tiles of a render are being traced, and by whom; raises NotFound."""
        render = await self.get_render(render_id)
        found = await self._in_database(self._folder.at_work, render.id)
        return AtWorkView(tiles=[TileAtWork(tile=tile, worker=worker) for tile, worker in found])

    async def release_worker(self, worker_id: str) -> None:
        """Takes the results of a worker in quarantine again; raises NotFound."""
        async with self._recorded(f"release {worker_id[:80]}"):
            CALLER.get().need("admin")
            await self._in_database(self._folder.release_worker, worker_id)

    # Webhooks

    async def create_webhook(self, url: str) -> NewWebhookView:
        """Tells `url` how the caller's renders end. Raises InputError for what can't be told or asked."""
        async with self._recorded("create webhook"):
            CALLER.get().need("submit")
            self._webhook_rules.admit(url)
            owner = CALLER.get().name
            webhook, secret = await self._in_database(self._folder.webhooks.create, owner, url)
            return NewWebhookView(secret=secret, **asdict(webhook))

    async def list_webhooks(self) -> list[WebhookView]:
        """The caller's, oldest first; an admin gets everybody's."""
        caller = CALLER.get()
        caller.need("submit")
        owner = None if "admin" in caller.scopes else caller.name
        return [WebhookView.of(each) for each in await self._in_database(self._folder.webhooks.list, owner)]

    async def delete_webhook(self, webhook_id: str) -> None:
        """Tells it nothing more. Raises NotFound."""
        async with self._recorded(f"delete webhook {webhook_id[: limits.RECORDED_CHARACTERS]}"):
            CALLER.get().need_own(await self._in_database(self._folder.webhooks.owner_of, webhook_id))
            await self._in_database(self._folder.webhooks.delete, webhook_id)

    # Assets

    async def missing_assets(self, digests: list[str]) -> list[str]:
        """Which of these files are not stored yet, in the order asked, each once. Raises InputError."""
        CALLER.get().need("submit")
        if len(digests) > limits.DIGESTS_PER_REQUEST:
            message = f"{len(digests)} digests; at most {limits.DIGESTS_PER_REQUEST} in one request"
            raise InputError.at("$.sha256", message)
        raise_if(
            problem
            for index, digest in enumerate(digests)
            for problem in digest_problems(digest, f"$.sha256[{index}]")
        )
        return await asyncio.to_thread(self._folder.blobs.missing, list(dict.fromkeys(digests)))

    async def store_asset(self, sha256: str, size_bytes: int, pieces: AsyncIterator[bytes]) -> AssetView:
        """Stores one file under its digest; InputError, and nothing left, where size or digest differ."""
        async with self._recorded(f"upload {sha256[: limits.RECORDED_CHARACTERS]}"):
            CALLER.get().need("submit")
            raise_if(digest_problems(sha256, "sha256"))
            if await asyncio.to_thread(self._folder.blobs.has, sha256):
                async for _ in pieces:  # Read to the end, so that the sender is not cut off in mid-write.
                    pass
            else:
                await uploads.store(self._folder.blobs, sha256, size_bytes, pieces)
            return await self.asset(sha256)

    async def asset(self, sha256: str) -> AssetView:
        """One stored file; raises NotFound."""
        if "read" not in CALLER.get().scopes:
            CALLER.get().need("worker")
        raise_if(digest_problems(sha256, "sha256"))
        size = await asyncio.to_thread(self._folder.blobs.size, sha256)
        return AssetView(sha256=sha256, size_bytes=size)

    async def open_asset(self, sha256: str) -> OpenFile:
        """The bytes of an asset, a compiled scene or a packed mesh; raises NotFound."""
        if "read" not in CALLER.get().scopes:
            CALLER.get().need("worker")
        raise_if(digest_problems(sha256, "sha256"))
        path = await asyncio.to_thread(self._folder.blobs.path, sha256)
        opened = await open_file(path)
        if opened is None:
            raise NotFound(f"no asset {sha256}")
        return opened

    # Access

    async def identify(self, secret: str) -> Caller:
        """Who has this secret; raises Unauthenticated."""
        return caller_of(await self._in_database(self._folder.tokens.find, secret))

    # Health

    async def metrics(self) -> bytes:
        """Counts and states for Prometheus."""
        CALLER.get().need("read")
        return await self._in_database(metrics_text, self._folder)

    async def ready(self) -> bool:
        """Whether the data folder answers."""
        try:
            await self._change_counter()
        except Exception:
            return False
        return True

    # Inside

    @asynccontextmanager
    async def _changing(self, what: str, render_id: str, request_id: str = "") -> AsyncIterator[str]:
        """For a call that changes a render, the caller's own unless it may change all; gives the whole id."""
        async with self._recorded(what, render_id, request_id) as record:
            render = await self._in_database(self._folder.find_render, render_id)
            record.render_id = render.id
            CALLER.get().need_own(render.owner)
            yield render.id

    @asynccontextmanager
    async def _recorded(
        self, what: str, render_id: str = "", request_id: str = ""
    ) -> AsyncIterator["_Record"]:
        """Keeps a line of a call that changes something, or tried to."""
        record = _Record(render_id)
        outcome = "done"
        try:
            yield record
        except Exception as error:
            outcome = failure_of(error).kind.reason
            raise
        finally:
            await self._in_database(
                self._folder.record_call,
                CALLER.get().name,
                what,
                record.render_id[: limits.RECORDED_CHARACTERS],
                request_id[: limits.RECORDED_CHARACTERS],
                outcome,
                limits.CALLS_RECORDED,
            )

    @asynccontextmanager
    async def _compile_slot(self) -> AsyncIterator[None]:
        if self._waiting >= limits.COMPILES_WAITING:
            raise Overloaded(
                f"{limits.COMPILES_WAITING} scenes are waiting to be compiled; try again in a moment."
            )
        self._waiting += 1
        try:
            async with self._compiling:
                yield
        finally:
            self._waiting -= 1

    async def _open_image(self, render_id: str, path_of: Callable[[str], Path], what: str) -> OpenFile:
        render = await self.get_render(render_id)
        path = path_of(render.id)
        opened = await open_file(path)
        if opened is None and self._archiver is not None:
            await self._archiver.fetch(render.id, path)
            opened = await open_file(path)
        if opened is None:
            raise NotFound(
                f"no {what} yet" if not render.has_ended else f"no {what}: the render ended before its first"
            )
        return opened

    async def _change_counter(self) -> int:
        return await self._in_database(self._folder.change_counter)

    async def _find(self, render_id: str) -> RenderView | None:
        try:
            return await self.get_render(render_id)
        except NotFound:
            return None

    async def _newest(self) -> list[RenderView]:
        return (await self.list_renders(MAX_PAGE)).renders

    async def _in_database(self, call: Callable[_P, _T], *args: _P.args, **kwargs: _P.kwargs) -> _T:
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._database, partial(call, *args, **kwargs))
