"""Denoised pictures of renders, made when somebody asks."""

import asyncio
import shutil
import tempfile
from pathlib import Path

from nocturne_scene.errors import NotFound

from nocturne_api.denoising.pool import denoise_in_child
from nocturne_api.files.open_file import OpenFile, open_file
from nocturne_api.limits import PICTURE_PIXELS
from nocturne_api.operations.images import Images
from nocturne_api.operations.renders import Renders


class Denoised:
    """The pictures of the image that was denoised last are kept: its files are asked for one by one."""

    def __init__(self, renders: Renders, images: Images) -> None:
        self._renders = renders
        self._images = images
        self._kept = tempfile.TemporaryDirectory(prefix="nocturne-denoised-", ignore_cleanup_errors=True)
        self._one_by_one = asyncio.Lock()

    def close(self) -> None:
        """Removes what is kept."""
        self._kept.cleanup()

    async def open(self, render_id: str, name: str) -> OpenFile:
        """A file by its name in `denoising.pictures`. Raises NotFound: no image yet, or no denoiser."""
        render = await self._renders.get(render_id)
        if render.width * render.height > PICTURE_PIXELS:
            raise NotFound(f"images of more than {PICTURE_PIXELS} pixels are not denoised")
        folder = Path(self._kept.name) / f"{render.id}-{render.sequence}"
        async with self._one_by_one:
            if not folder.exists():
                await self._make(render.id, folder)
            opened = await open_file(folder / name)
        if opened is None:
            raise NotFound("no denoised picture")
        return opened

    async def _make(self, render_id: str, folder: Path) -> None:
        root = Path(self._kept.name)
        image = await self._images.open_exr(render_id)
        await asyncio.to_thread(_empty, root)
        with image.file, (root / "image.exr").open("wb") as file:
            await asyncio.to_thread(shutil.copyfileobj, image.file, file)
        unfinished = root / "unfinished"
        unfinished.mkdir()
        await denoise_in_child(root / "image.exr", unfinished)
        unfinished.rename(folder)


def _empty(folder: Path) -> None:
    for each in folder.iterdir():
        if each.is_dir():
            shutil.rmtree(each, ignore_errors=True)
        else:
            each.unlink()
