"""Reports on the light of a room, of renders and of their groups."""

import asyncio
import json
import re
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Literal

from nocturne_coordinator.store.rows import RenderRow
from nocturne_scene.errors import InputError, NocturneError
from nocturne_scene.photometry.requirements import requirement

from nocturne_api.children.pools import report_in_child
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.models.renders import Render
from nocturne_api.operations.annual import Annual, YearQuestion
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.images import Images
from nocturne_api.operations.renders import Renders
from nocturne_api.places import to_the_end

Kind = Literal["pdf", "html", "json"]
_MOST_TEXT = 200
_PANORAMAS = 8
"""Of a group, that are rated for glare."""


@dataclass(frozen=True, slots=True)
class ReportQuestion:
    """What a report is to tell."""

    require: str = ""
    """A row of a standard, or limits; see nocturne_scene.photometry.requirements."""
    task: str = ""
    """The instrument that it is for."""
    title: str = ""


class Reports:
    """Reports on the renders of one data folder."""

    def __init__(
        self,
        access: FolderAccess,
        renders: Renders,
        images: Images,
        annual: Annual,
        compile_limits: CompileLimits,
    ) -> None:
        self._access, self._renders, self._images = access, renders, images
        self._annual, self._compile_limits = annual, compile_limits

    async def make(self, render_id: str, kind: Kind, asked: ReportQuestion) -> bytes:
        """Of a render of meters; panoramas of its group are rated for glare, and its year is told.

        Raises NotFound, also where there is nothing to report on yet; InputError; Overloaded.
        """
        _check(asked)
        render = await self._renders.get(render_id)
        document = await self._access.in_database(self._access.folder.renders.scene_document, render.id)
        others = await self._others(render)
        with tempfile.TemporaryDirectory(prefix="nocturne-report-") as name:
            folder = Path(name)
            job = {
                "folder": name,
                "image": await self._image(render.id, folder),
                "scene": json.loads(document),
                "output": f"report.{kind}",
                "require": asked.require,
                "task": asked.task,
                "title": asked.title or render.name,
                "glare": [
                    await self._image(row.id, folder)
                    for row in others
                    if row.sensor == "panorama" and row.ranges_done > 0
                ][:_PANORAMAS],
                "annual": await self._year(others, folder),
            }
            await report_in_child(job, self._access.folder.blobs, self._compile_limits)
            return await asyncio.to_thread((folder / job["output"]).read_bytes)

    async def _others(self, render: Render) -> list[RenderRow]:
        """Of the render's group."""
        if not render.group:
            return []
        page = self._access.folder.renders.page
        rows, _ = await self._access.in_database(lambda: page(200, "", render.owner, render.group))
        return [row for row in rows if row.id != render.id]

    async def _image(self, render_id: str, folder: Path) -> str:
        """The name of its file, which a report shows."""
        path = folder / f"{re.sub('[^A-Za-z0-9-]', '-', render_id)}.exr"
        image = await self._images.open_exr(render_id)
        await to_the_end(_copy, image.file, path)
        return path.name

    async def _year(self, others: list[RenderRow], folder: Path) -> str:
        daylight = next((row for row in others if row.sensor == "daylight"), None)
        if daylight is None:
            return ""
        try:
            year = await self._annual.year(daylight.id, YearQuestion())
        except NocturneError:
            # Its renders are not all there.
            return ""
        await asyncio.to_thread((folder / "year.json").write_text, year)
        return "year.json"


def _copy(image: BinaryIO, path: Path) -> None:
    with image, path.open("wb") as copy:
        shutil.copyfileobj(image, copy)


def _check(asked: ReportQuestion) -> None:
    for name, text in (("require", asked.require), ("task", asked.task), ("title", asked.title)):
        if len(text) > _MOST_TEXT or (text and not text.isprintable()) or text.startswith("-"):
            raise InputError.at(name, f"expected at most {_MOST_TEXT} printable characters, no dash at first")
    if asked.require:
        try:
            requirement(asked.require)
        except InputError as error:
            raise InputError.at("require", error.problems[0].message) from None
