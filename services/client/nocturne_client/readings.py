"""What a part of a render's image shows, in numbers, from the tiles that the service sends. Needs numpy."""

import math
import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nocturne_client.client import Client
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Region, Render

_CONFIDENCE = 1.96
"""Standard errors to each side of a 95 % interval."""

_NONE_OF_N = 3.0
"""Of n samples none met light: with 95 %, fewer than 3 in n do. Hanley and Lippman-Hand, "If nothing goes
wrong, is everything all right?" (JAMA 249, 1983)."""


@dataclass(frozen=True)
class Reading:
    """Means over the pixels of a region that have samples."""

    region: Region
    quantity: str
    unit: str
    value: float
    """Of Y."""
    standard_error: float | None
    """Of the value, taking pixels as independent of each other; null where it is not known."""
    xyz: tuple[float, float, float]
    samples: int
    """Of all pixels together."""
    unseen_pixels: int
    pixels: int

    def __str__(self) -> str:
        if self.value <= 0.0:
            bound = f"fewer than 1 in {self.samples / _NONE_OF_N:,.0f} meet any (95 %)"
            return f"nothing seen: none of {self.samples:,} samples met light" + (
                f", so {bound}" if self.samples > _NONE_OF_N else ""
            )
        known = self.standard_error is not None
        interval = f" +- {_CONFIDENCE * (self.standard_error or 0.0):.2g}" if known else ""
        unseen = f"; nothing seen in {self.unseen_pixels:,} of {self.pixels:,} pixels"
        told = f"{self.quantity or 'Y'} {self.value:.5g}{interval} {self.unit}".rstrip()
        return told + (" (95 %)" if known else "") + (unseen if self.unseen_pixels else "")


def parse_region(text: str) -> Region:
    """From "X,Y,WIDTH,HEIGHT", pixels from the upper left corner; "X,Y" is one pixel.

    Raises NocturneClientError.
    """
    numbers = [int(each) for each in re.split(r"\s*,\s*", text.strip()) if each.isdecimal()]
    if len(numbers) not in (2, 4) or not re.fullmatch(r"[\d\s,]+", text):
        raise NocturneClientError(f"--region {text}: expected X,Y,WIDTH,HEIGHT in pixels, or X,Y")
    x, y, width, height = numbers if len(numbers) == 4 else (*numbers, 1, 1)
    return Region(x, y, width, height)


def read_region(client: Client, render: Render, region: Region) -> Reading:
    """Raises NocturneClientError where it lies outside of the film, or nothing is rendered there yet."""
    x, y, width, height = region.x, region.y, region.width, region.height
    if not (width and height and x + width <= render.width and y + height <= render.height):
        raise NocturneClientError(
            f"the region {x},{y},{width},{height} is not within the film of {render.width} x {render.height}"
        )
    pixels: list[npt.NDArray[np.float64]] = []
    counts: list[int] = []
    since, more = "", True
    while more:
        answer = client.tiles(render.id, since)
        since, more = answer.cursor, answer.more
        for tile in answer.tiles:
            rows = slice(max(0, y - tile.y), max(0, y + height - tile.y))
            columns = slice(max(0, x - tile.x), max(0, x + width - tile.x))
            part = tile.pixels[rows, columns].reshape(-1, 4).astype(np.float64)
            if part.size and tile.samples:
                pixels.append(part)
                counts.append(tile.samples)
    if not pixels:
        raise NocturneClientError(f"{render.id} has no samples there yet")
    found = np.concatenate(pixels)
    error = math.sqrt(float(np.sum(found[:, 3] ** 2))) / len(found)
    mean = found[:, :3].mean(axis=0)
    return Reading(
        region,
        render.quantity,
        render.unit,
        float(mean[1]),
        error if min(counts) > 1 and mean[1] > 0.0 else None,
        (float(mean[0]), float(mean[1]), float(mean[2])),
        sum(count * len(part) for count, part in zip(counts, pixels, strict=True)),
        int(np.count_nonzero(found[:, 1] <= 0.0)),
        len(found),
    )
