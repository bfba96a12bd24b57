"""For those who are asked why a render is as it is: its log, and a ZIP of all that is known of it."""

import asyncio
import io
import zipfile

from nocturne_coordinator.store.render_log import log_of

from nocturne_api.models.renders import Render
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders


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
