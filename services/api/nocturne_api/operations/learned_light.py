"""What guides the photons of renders, at single pixels."""

from nocturne_coordinator.dispatch.region import Region
from nocturne_scene.errors import NotFound

from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.learned.pool import Place, learned_in_child
from nocturne_api.models.learned_light import LearnedLight
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders


class LearnedLights:
    """Lookups for the renders that callers may see."""

    def __init__(self, access: FolderAccess, renders: Renders, compile_limits: CompileLimits) -> None:
        self._access = access
        self._renders = renders
        self._compile_limits = compile_limits

    async def at(self, render_id: str, x: int, y: int) -> LearnedLight:
        """At what the pixel's middle shows. Raises NotFound, also for a render whose photons are not guided,
        InputError and Overloaded."""
        render = await self._renders.get(render_id)
        Region(x, y, 1, 1).check(render.width, render.height)
        if not render.guided:
            raise NotFound(f"no photons of {render.id} are guided: its pilot found no use for that")
        folder = self._access.folder
        schedule = await self._access.in_database(folder.renders.schedule, render.id)
        place = Place(render.scene_sha256, schedule, x, y)
        return LearnedLight.of(await learned_in_child(place, folder.blobs, self._compile_limits))
