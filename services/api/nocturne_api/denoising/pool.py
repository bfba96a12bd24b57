"""Denoises images in throw-away child processes; one that takes too long is ended."""

import asyncio
import sys
from pathlib import Path

from nocturne_scene.errors import NotFound

from nocturne_api.limits import DENOISE_WALL_S

_PROGRAM = ("-m", "nocturne_api.denoising.child")


async def denoise_in_child(image: Path, folder: Path) -> None:
    """Writes the files of `denoising.pictures` into `folder`. Raises NotFound, which says why."""
    child = await asyncio.create_subprocess_exec(
        *(sys.executable, *_PROGRAM, str(image), str(folder)), stdout=asyncio.subprocess.PIPE
    )
    try:
        async with asyncio.timeout(DENOISE_WALL_S):
            said, _ = await child.communicate()
    except TimeoutError:
        raise NotFound(f"the image could not be denoised within {DENOISE_WALL_S:g} s") from None
    finally:
        if child.returncode is None:
            child.kill()
            await child.wait()
    if child.returncode:
        raise NotFound(said.decode("utf-8", "replace") or "the denoiser failed; the service's log says why")
