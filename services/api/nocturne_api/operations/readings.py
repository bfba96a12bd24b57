"""What regions of renders show, in numbers, with their errors, and what guides the photons of a pixel."""

import math

import numpy as np
from nocturne_coordinator.dispatch.region import Region
from nocturne_scene.errors import NotFound
from nocturne_scene.photometry.plain_values import plain_polarisation
from nocturne_scene.photometry.polarisation import polarisation_of
from nocturne_scene.quantities import quantity_named
from nocturne_scene.uncertainty import RegionReading, RegionSums

from nocturne_api.children.pools import Place, learned_in_child
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.models.measurements import LearnedLight, LinearPolarisation, Reading, ReadValue
from nocturne_api.models.renders import Region as RegionModel
from nocturne_api.operations.film_parts import film_parts, names_of
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders


class Readings:
    """Numbers of renders as they are now."""

    def __init__(self, access: FolderAccess, renders: Renders) -> None:
        self._access = access
        self._renders = renders

    async def read(self, render_id: str, region: Region | None) -> Reading:
        """Of all pixels where there is no region; raises NotFound, also where nothing is rendered yet, and
        InputError."""
        render = await self._renders.get(render_id)
        wanted = region or Region(0, 0, render.width, render.height)
        wanted.check(render.width, render.height)
        schedule = await self._access.in_database(self._access.folder.renders.schedule, render.id)
        names = names_of(schedule)
        sums, invalid_samples = RegionSums(len(names)), 0
        async for part in film_parts(self._access, render.id, schedule, wanted):
            height, width = part.image.samples.shape
            y, x = part.top + np.arange(height), part.left + np.arange(width)
            within_y = (y >= wanted.y) & (y < wanted.y + wanted.height)
            within_x = (x >= wanted.x) & (x < wanted.x + wanted.width)
            sums.add(part.image, within_y[:, None] & within_x)
            invalid_samples += part.invalid_samples
        found = sums.reading()
        if found is None:
            raise NotFound(f"{render.id} has no samples there yet")
        return _answer(found, wanted, render.quantity, names, invalid_samples)


def _answer(
    found: RegionReading, region: Region, quantity_name: str, names: list[str], invalid_samples: int
) -> Reading:
    quantity = quantity_named(quantity_name)
    values = zip(names, found.mean, found.error, strict=True)
    chromaticity, chromaticity_error = found.chromaticity, found.chromaticity_error
    if not quantity.has_colour:
        chromaticity = chromaticity_error = (math.nan, math.nan)
    u, v = map(known, chromaticity)
    u_error, v_error = map(known, chromaticity_error)
    polarised = plain_polarisation(polarisation_of(found, names))
    return Reading(
        region=RegionModel(x=region.x, y=region.y, width=region.width, height=region.height),
        quantity=quantity.name,
        unit=quantity.unit,
        response_unit=quantity.response_unit,
        values=[ReadValue(name=name, mean=mean, standard_error=known(error)) for name, mean, error in values],
        u_prime=u,
        v_prime=v,
        u_prime_error=u_error,
        v_prime_error=v_error,
        correlation=found.correlation,
        coverage_factor=known(found.coverage_factor),
        pixels=found.pixels,
        zero_pixels=found.zero_pixels,
        samples=found.samples,
        fewest_samples=found.samples_per_pixel[0],
        most_samples=found.samples_per_pixel[1],
        invalid_samples=invalid_samples,
        linear_polarisation=None if polarised is None else LinearPolarisation.model_validate(polarised),
    )


def known(value: float) -> float | None:
    """None where it is not."""
    return None if math.isnan(value) else value


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
