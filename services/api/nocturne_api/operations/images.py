"""Images of renders: files, and the tiles that changed."""

import asyncio
import tempfile
from collections.abc import Callable
from pathlib import Path

from nocturne_coordinator.output.previews import layers_of
from nocturne_scene.errors import NotFound
from nocturne_scene.limits import MAX_RANGES

from nocturne_api.access import CALLER
from nocturne_api.background.archiver import Archiver
from nocturne_api.files.current_image import read_current, write_current
from nocturne_api.files.open_file import OpenFile, open_file
from nocturne_api.files.tiles import Cursor, TileAnswers, Tiles, encode, runs, tiles_per_answer
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders


class Images:
    """What a render looks like now."""

    def __init__(self, access: FolderAccess, renders: Renders, archiver: Archiver | None) -> None:
        """`archiver` gets back files that are in the object store only."""
        self._access = access
        self._folder = access.folder
        self._renders = renders
        self._archiver = archiver
        self._writing = asyncio.Semaphore(1)
        self._tile_answers = TileAnswers(self._read_tiles)

    async def open_thumbnail(self, render_id: str) -> OpenFile:
        """A small tone-mapped PNG for lists; raises NotFound, also before the first."""
        return await self._open(render_id, self._folder.thumbnail_path, "thumbnail")

    async def open_preview(self, render_id: str) -> OpenFile:
        """The tone-mapped PNG of what is merged now; raises NotFound, also before the first preview."""
        return await self._open(render_id, self._folder.preview_path, "preview")

    async def open_exr(self, render_id: str) -> OpenFile:
        """The EXR of what is committed now; raises NotFound, also before the first samples."""
        render = await self._renders.get(render_id)
        if not render.has_ended:
            return await self._current_image(render.id)
        return await self._open(render_id, self._folder.image_path, "image")

    async def open_scene(self, render_id: str) -> str:
        """The scene document as it was submitted, JSON; raises NotFound."""
        render = await self._renders.get(render_id)
        return await self._access.in_database(self._folder.renders.scene_document, render.id)

    async def tiles(self, render_id: str, since: Cursor) -> Tiles:
        """What of the image changed since; raises NotFound."""
        render = await self._renders.get(render_id)
        return await self._tile_answers.get(render.id, since, render.sequence)

    async def changed_tiles(self, render_id: str, since: int, last: int) -> list[tuple[int, int]]:
        """First and last indices of the tiles whose latest revisions are above `since`, at most `last`."""
        CALLER.get().need("read")
        changes = await self._access.in_database(
            self._folder.tiles.changed, render_id, (since, MAX_RANGES), MAX_RANGES
        )
        return runs([change.tile_index for change in changes if change.revision <= last])

    async def _current_image(self, render_id: str) -> OpenFile:
        # One after the other: each holds all sums of a film.
        async with self._writing:
            current = await self._access.in_database(read_current, self._folder, render_id)
            layers = await asyncio.to_thread(layers_of, self._folder, current[0].layers_sha256)
            with tempfile.TemporaryDirectory(prefix="nocturne-image-") as folder:
                path = Path(folder) / "image.exr"
                await asyncio.to_thread(write_current, path, *current, layers)
                opened = await open_file(path)
        if opened is None:
            raise NotFound("no image yet")
        return opened

    async def _read_tiles(self, render_id: str, since: Cursor) -> Tiles:
        schedule = await self._access.in_database(self._folder.renders.schedule, render_id)
        most = tiles_per_answer(schedule)
        place = (since.revision, since.tile_index)
        found = await self._access.in_database(self._folder.tiles.sums, render_id, place, most + 1)
        return await asyncio.to_thread(encode, schedule, since, found[:most], len(found) > most)

    async def _open(self, render_id: str, path_of: Callable[[str], Path], what: str) -> OpenFile:
        render = await self._renders.get(render_id)
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
