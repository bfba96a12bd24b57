"""Turns image files into tiles, each in a throw-away child process, which is ended if it takes too long."""

import asyncio
import sys
from pathlib import Path

from nocturne_scene.errors import InputError

from nocturne_api.errors import Overloaded
from nocturne_api.limits import PICTURE_WALL_S, PICTURES_AT_ONCE
from nocturne_api.pictures.child import UNREADABLE

_PROGRAM = ("-m", "nocturne_api.pictures.child")
_at_once = asyncio.Semaphore(PICTURES_AT_ONCE)


async def picture_as_tiles(file: Path, tiles: Path, edge: int) -> None:
    """Writes `tiles`, squares of `edge` pixels, as `nocturne_api.files.tiles` describes them.

    Raises InputError for a file that can't be shown, Overloaded where others are being read.
    """
    if _at_once.locked():
        raise Overloaded(f"{PICTURES_AT_ONCE} pictures are being read; try again.")
    async with _at_once:
        child = await asyncio.create_subprocess_exec(
            *(sys.executable, *_PROGRAM, str(file), str(tiles), str(edge)), stdout=asyncio.subprocess.PIPE
        )
        try:
            async with asyncio.timeout(PICTURE_WALL_S):
                said, _ = await child.communicate()
        except TimeoutError:
            raise InputError.at("$", f"could not be read within {PICTURE_WALL_S:g} s") from None
        finally:
            if child.returncode is None:
                child.kill()
                await child.wait()
    if child.returncode == UNREADABLE:
        raise InputError.at("$", said.decode("utf-8", "replace"))
    if child.returncode:
        raise InputError.at("$", "could not be read within the memory that there is for it")
