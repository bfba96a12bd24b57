"""Photometry of renders as they are now: regions, lines, histograms, isolines and glare."""

import asyncio
import math
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from nocturne.v1 import scene_pb2
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.output.pictures import layers_of
from nocturne_scene.errors import InputError, NotFound
from nocturne_scene.layers import CHANNELS
from nocturne_scene.layers import Values as LayerValues
from nocturne_scene.photometry import arriving_light, glare, isolines, measuring
from nocturne_scene.photometry.outlines import Outline
from nocturne_scene.photometry.places import Places
from nocturne_scene.photometry.plain_values import MeasuredOutline, plain, plain_measurements
from nocturne_scene.quantities import quantity_named
from nocturne_scene.tile_sums import Values
from nocturne_scene.uncertainty import ImageMoments

from nocturne_api import limits
from nocturne_api.models import measurements as models
from nocturne_api.models.renders import Render
from nocturne_api.operations.film_parts import FilmPart, film_parts, names_of
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders

_Named = tuple[str, Outline]


@dataclass(frozen=True, slots=True)
class _Channel:
    """Which of a render's quantities is asked for."""

    index: int
    quantity: str
    unit: str
    names: Sequence[str]
    """Of all channels."""


class Measurements:
    """Photometry of the renders of one data folder."""

    def __init__(self, access: FolderAccess, renders: Renders) -> None:
        self._access = access
        self._renders = renders
        self._measuring = asyncio.Semaphore(limits.MEASUREMENTS_AT_ONCE)

    async def regions(self, render_id: str) -> models.MeasuredRegions:
        """Those that are kept with a render; raises NotFound."""
        render = await self._renders.get(render_id)
        return _kept(await self._access.in_database(self._access.folder.measured_regions.of, render.id))

    async def keep_regions(
        self, render_id: str, regions: Sequence[models.OutlineRequest]
    ) -> models.MeasuredRegions:
        """Keeps these instead of all that were kept. Raises NotFound, InputError."""
        async with self._access.changing("keep regions", render_id) as whole_id:
            render = await self._renders.get(whole_id)
            wanted = _checked(regions, render, "$.regions")
            await self._access.writing(self._access.folder.measured_regions.keep, whole_id, wanted)
            return _kept(wanted)

    async def measure(self, render_id: str, request: models.MeasureRequest) -> models.Measurements:
        """Raises NotFound, also where nothing is rendered yet, and InputError."""
        render = await self._renders.get(render_id)
        channel = await self._channel(render, request.channel)
        wanted = _checked(request.outlines, render, "$.outlines")
        if not wanted:
            wanted = await self._access.in_database(self._access.folder.measured_regions.of, render.id)
        places = await self._places(render)
        if not wanted:
            wanted = places.outlines()
        if not wanted:
            wanted = [("", Outline("rectangle", ((0.0, 0.0), (float(render.width), float(render.height)))))]
        found = []
        async with self._measuring:
            outdoor = await self._outdoor(render, places, channel)
            for name, outline in wanted:
                measured = await self._measured(render, outline, channel)
                colour = await self._colour(render, measured, channel) if request.colour else []
                daylight = None if outdoor is None else measuring.daylight_factor(measured, outdoor)
                histogram = None
                if request.bins:
                    histogram = await self._histogram(render, outline, measured, channel, request)
                found.append(MeasuredOutline(name, outline, measured, histogram, colour, daylight))
        return models.Measurements.model_validate(
            plain_measurements(
                found, places, request.channel, channel.names, (channel.quantity, channel.unit)
            )
        )

    async def isolines(
        self, render_id: str, levels: Sequence[float], channel_name: str = "Y"
    ) -> models.Isolines:
        """Without levels, at round numbers. Raises NotFound, also where nothing is rendered yet, and
        InputError."""
        if len(levels) > isolines.MAX_LEVELS or not all(map(math.isfinite, levels)):
            raise InputError.at("$.level", f"expected at most {isolines.MAX_LEVELS} finite numbers")
        render = await self._renders.get(render_id)
        channel = await self._channel(render, channel_name)
        blocks = isolines.BlockMeans(render.width, render.height)
        async for part in self._parts(render, Region(0, 0, render.width, render.height)):
            mean, variance = part.image.mean[..., channel.index], part.image.variance[..., channel.index]
            known = part.image.samples > 0
            await asyncio.to_thread(blocks.add, mean, variance, known, part.left, part.top)
        blocks.calm()
        means = blocks.means()
        if not np.isfinite(means).any():
            raise NotFound(f"{render.id} has no samples yet")
        wanted = sorted({*(levels or isolines.round_levels(means))})
        found = [
            models.Isoline(
                level=level,
                lines=[
                    [[*point] for point in line] for line in await asyncio.to_thread(blocks.isolines, level)
                ],
            )
            for level in wanted
        ]
        return models.Isolines(
            quantity=channel.quantity, unit=channel.unit, block=blocks.edge, isolines=found
        )

    async def glare(self, render_id: str, view: glare.View) -> models.Glare:
        """Of a panorama. Raises NotFound, also where nothing is rendered yet, and InputError for other
        renders."""
        render = await self._renders.get(render_id)
        model = await asyncio.to_thread(self._sensor_model, render)
        if model != scene_pb2.SENSOR_MODEL_PANORAMA:
            raise InputError.at(
                "$", "glare is taken of what is all around an eye; give the scene a sensor of type panorama"
            )
        if render.width * render.height > glare.MAX_PIXELS:
            raise InputError.at("$", f"glare is taken of {glare.MAX_PIXELS} pixels at most")
        image = _Whole(render.width, render.height)
        async for part in self._parts(render, Region(0, 0, render.width, render.height)):
            image.add(part)
        quantity, emission = quantity_named(render.quantity), await self._emission(render.id)
        rate = partial(glare.glare_of, image.moments(), quantity, "panorama", view, emission=emission)
        return models.Glare.model_validate(plain(await asyncio.to_thread(rate)))

    async def _emission(self, render_id: str) -> LayerValues | None:
        """The layer of that name; None where the render has none, or none yet."""
        folder = self._access.folder
        row = await self._access.in_database(folder.renders.get, render_id)
        layers = await asyncio.to_thread(layers_of, folder, row.layers_sha256)
        return layers.channels.get(*CHANNELS["emission"])

    def _sensor_model(self, render: Render) -> "scene_pb2.SensorModel.ValueType":
        path = self._access.folder.blobs.path(render.scene_sha256)
        return scene_pb2.CompiledScene.FromString(path.read_bytes()).sensor.model

    async def _channel(self, render: Render, name: str) -> _Channel:
        schedule = await self._access.in_database(self._access.folder.renders.schedule, render.id)
        names = names_of(schedule)
        if name not in names:
            raise InputError.at("$.channel", f"{name[:40]!r} is not known; expected {', '.join(names)}")
        return _Channel(names.index(name), *quantity_named(render.quantity).of_channel(name, names), names)

    async def _places(self, render: Render) -> Places:
        schedule = await self._access.in_database(self._access.folder.renders.schedule, render.id)
        return Places.read(schedule.instruments, render.width, render.height)

    async def _outdoor(self, render: Render, places: Places, channel: _Channel) -> measuring.Measured | None:
        outlines = dict(places.outlines())
        if places.outdoor not in outlines:
            return None
        return await self._measured(render, outlines[places.outdoor], channel)

    async def _colour(
        self, render: Render, found: measuring.Measured, channel: _Channel
    ) -> list[arriving_light.ColourValue]:
        if not arriving_light.has_colour(channel.names):
            return []
        quantity = quantity_named(render.quantity)
        return await asyncio.to_thread(arriving_light.colour_of, found.reading, channel.names, quantity)

    async def _parts(self, render: Render, region: Region) -> AsyncIterator[FilmPart]:
        schedule = await self._access.in_database(self._access.folder.renders.schedule, render.id)
        async for part in film_parts(self._access, render.id, schedule, region):
            yield part

    async def _measured(self, render: Render, outline: Outline, channel: _Channel) -> measuring.Measured:
        adding: measuring.Measuring | None = None
        async for part in self._parts(render, _around(outline)):
            adding = adding or measuring.Measuring(outline, part.image.mean.shape[-1], channel.index)
            await asyncio.to_thread(adding.add, part.image, part.left, part.top)
        found = adding.measured() if adding else None
        if found is None:
            raise NotFound(f"{render.id} has no samples there yet")
        return found

    async def _histogram(
        self,
        render: Render,
        outline: Outline,
        found: measuring.Measured,
        channel: _Channel,
        asked: models.MeasureRequest,
    ) -> measuring.Histogram:
        low, high = measuring.histogram_range(found, asked.low, asked.high, asked.logarithmic)
        histogram = measuring.Histogram(low, high, asked.bins, asked.logarithmic)
        async for part in self._parts(render, _around(outline)):
            values = await asyncio.to_thread(_values, part, outline, channel.index)
            await asyncio.to_thread(histogram.add, values)
        return histogram


class _Whole:
    """Y of an image, and how far its errors are known, put together from its parts."""

    def __init__(self, width: int, height: int) -> None:
        self._size = width, height
        self._parts: list[FilmPart] = []

    def add(self, part: FilmPart) -> None:
        self._parts.append(part)

    def moments(self) -> ImageMoments:
        """Raises NotFound where some of it is not there yet."""
        width, height = self._size
        rows: dict[int, list[FilmPart]] = {}
        for part in self._parts:
            rows.setdefault(part.top, []).append(part)
        found = [parts[0].image for _, parts in sorted(rows.items())]
        whole = all(parts[0].image.samples.shape[1] == width for parts in rows.values())
        if not whole or sum(len(image.samples) for image in found) != height:
            raise NotFound("parts of the image have no samples yet")
        fields = ("mean", "variance", "one_more", "covariance", "block_covariance", "tile_variance")
        arrays = {name: np.concatenate([getattr(image, name) for image in found]) for name in fields}
        return ImageMoments(
            **arrays, tile_size=found[0].tile_size, samples=np.concatenate([each.samples for each in found])
        )


def _values(part: FilmPart, outline: Outline, index: int) -> Values:
    height, width = part.image.samples.shape
    chosen = outline.mask(part.left, part.top, width, height) & (part.image.samples > 0)
    values: Values = part.image.mean[chosen][:, index]
    return values


def _around(outline: Outline) -> Region:
    left, top, right, bottom = outline.bounds()
    return Region(left, top, right - left, bottom - top)


def _checked(requests: Sequence[models.OutlineRequest], render: Render, place: str) -> list[_Named]:
    """Raises InputError with the place of one that is not in the film."""
    found: list[_Named] = []
    for index, request in enumerate(requests):
        at = f"{place}[{index}]"
        if any(len(point) != len("xy") for point in request.points):
            raise InputError.at(f"{at}.points", "expected [x, y] for each point")
        if not request.name.isprintable():
            raise InputError.at(f"{at}.name", "expected printable characters")
        outline = Outline(request.kind, tuple((x, y) for x, y in request.points))
        outline.check(render.width, render.height, at)
        found.append((request.name, outline))
    return found


def _kept(regions: Sequence[_Named]) -> models.MeasuredRegions:
    return models.MeasuredRegions(regions=[models.Outline.of(*each) for each in regions])
