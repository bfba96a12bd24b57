"""Images of renders: previews, EXR, tiles, denoised pictures; and bundles, which tell all about a render."""

import asyncio
import io
import shutil
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from nocturne_coordinator.output.pictures import layers_of
from nocturne_coordinator.store.render_log import log_of
from nocturne_scene.errors import NotFound
from nocturne_scene.limits import MAX_RANGES

from nocturne_api import limits
from nocturne_api.access import CALLER
from nocturne_api.background.archiver import Archiver
from nocturne_api.children.pools import denoise_in_child
from nocturne_api.files.current_image import read_current, write_current
from nocturne_api.files.open_file import OpenFile, open_file
from nocturne_api.files.tiles import Cursor, TileAnswers, Tiles, encode, runs, tiles_per_answer
from nocturne_api.limits import PICTURE_PIXELS
from nocturne_api.models.renders import Render
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders
from nocturne_api.places import Places, to_the_end


class Images:
    """What a render looks like now."""

    def __init__(self, access: FolderAccess, renders: Renders, archiver: Archiver | None) -> None:
        """`archiver` gets back files that are in the object store only."""
        self._access = access
        self._folder = access.folder
        self._renders = renders
        self._archiver = archiver
        # One after the other: each holds all sums of a film.
        self._writing = Places(1, limits.IMAGES_WAITING, "Other images are being written; try again.")
        self._tile_answers = TileAnswers(self._read_tiles)

    async def open_thumbnail(self, render_id: str) -> OpenFile:
        """A small tone-mapped PNG for lists; raises NotFound, also before the first."""
        return await self._open(render_id, self._folder.thumbnail_path, "thumbnail")

    async def open_preview(self, render_id: str) -> OpenFile:
        """The tone-mapped PNG of the samples merged so far; raises NotFound, also before the first one."""
        return await self._open(render_id, self._folder.preview_path, "preview")

    async def open_exr(self, render_id: str) -> OpenFile:
        """The EXR of the samples committed by now; raises NotFound, also before the first samples."""
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
        async with self._writing.one():
            current = await to_the_end(read_current, self._folder, render_id)
            layers = await asyncio.to_thread(layers_of, self._folder, current[0].layers_sha256)
            with tempfile.TemporaryDirectory(prefix="nocturne-image-") as folder:
                path = Path(folder) / "image.exr"
                await to_the_end(write_current, path, *current, layers)
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


class Denoised:
    """The pictures of the image that was denoised last are kept: its files are asked for one by one."""

    def __init__(self, renders: Renders, images: Images) -> None:
        self._renders = renders
        self._images = images
        self._kept = tempfile.TemporaryDirectory(prefix="nocturne-denoised-", ignore_cleanup_errors=True)
        self._one_by_one = Places(1, limits.DENOISES_WAITING, "Other images are being denoised; try again.")

    def close(self) -> None:
        """Removes the kept pictures."""
        self._kept.cleanup()

    async def open(self, render_id: str, name: str) -> OpenFile:
        """A file by its name in `children.denoising`. Raises NotFound: no image yet, or no denoiser."""
        render = await self._renders.get(render_id)
        if render.width * render.height > PICTURE_PIXELS:
            raise NotFound(f"images of more than {PICTURE_PIXELS} pixels are not denoised")
        folder = Path(self._kept.name) / f"{render.id}-{render.sequence}"
        async with self._one_by_one.one():
            if not await asyncio.to_thread(folder.exists):
                await self._make(render.id, folder)
            opened = await open_file(folder / name)
        if opened is None:
            raise NotFound("no denoised picture")
        return opened

    async def _make(self, render_id: str, folder: Path) -> None:
        root = Path(self._kept.name)
        image = await self._images.open_exr(render_id)
        await asyncio.to_thread(_empty, root)
        unfinished = root / "unfinished"
        await to_the_end(_copy, image.file, root / "image.exr", unfinished)
        await denoise_in_child(root / "image.exr", unfinished)
        await asyncio.to_thread(unfinished.rename, folder)


def _copy(image: BinaryIO, file: Path, folder: Path) -> None:
    with image, file.open("wb") as copy:
        shutil.copyfileobj(image, copy)
    folder.mkdir()


def _empty(folder: Path) -> None:
    for each in folder.iterdir():
        if each.is_dir():
            shutil.rmtree(each, ignore_errors=True)
        else:
            each.unlink()


class Bundles:
    """Logs and bundles of the renders that callers may see."""

    def __init__(self, access: FolderAccess, renders: Renders) -> None:
        self._access = access
        self._renders = renders

    async def log(self, render_id: str) -> str:
        """What happened to it, line by line; raises NotFound."""
        render = await self._renders.get(render_id)
        return str(await self._access.in_database(log_of, self._access.folder, render.id))

    async def bundle(self, render_id: str) -> bytes:
        """A ZIP: its state, log, scene document, schedule, and what reproduces the failures of tiles. Raises
        NotFound."""
        render = await self._renders.get(render_id)
        folder = self._access.folder
        log, document, schedule = await self._access.in_database(
            lambda: (
                log_of(folder, render.id),
                folder.renders.scene_document(render.id),
                folder.renders.schedule(render.id),
            )
        )
        parts = {
            "render.json": render.model_dump_json(indent=1).encode(),
            "log.txt": log.encode(),
            "scene.json": document.encode(),
            "schedule.pb": schedule.SerializeToString(deterministic=True),
        }
        return await asyncio.to_thread(self._zipped, render, parts)

    def _zipped(self, render: Render, parts: dict[str, bytes]) -> bytes:
        whole = io.BytesIO()
        with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in parts.items():
                archive.writestr(name, content)
            beside = self._access.folder.bundle_path(render.id, 0).parent
            for failure in sorted(beside.glob("failed-tile-*.zip")):
                archive.write(failure, failure.name)
        return whole.getvalue()
