"""From sums to quantities that people look at and measure: means, errors, EXR, PNG.

Files hold nothing but content (no date, no host, no program version), so that equal images are equal files.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenEXR
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene import response_correlations
from nocturne_scene.bands import spectral_attributes
from nocturne_scene.layers import NO_LAYERS, Layers
from nocturne_scene.quantities import LUMINANCE, quantity_named
from nocturne_scene.render_warnings import RenderWarning, header_lines
from nocturne_scene.spectra.published import XYZ_TO_SRGB
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange
from nocturne_scene.tile_sums import (
    BLOCK,
    PAIR_FIRST,
    PAIR_SECOND,
    PAIRS,
    PRODUCTS_PAIRS,
    PRODUCTS_SQUARES,
    Values,
    block_sums,
    tile_sums,
)
from nocturne_scene.uncertainty import ImageMoments, moments_of

from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.dispatch.merge import Counts, Sums

# For rows of pixels.
_XYZ_TO_SRGB = XYZ_TO_SRGB.astype(np.float32).T

# The primaries and the white of IEC 61966-2-1: x and y of red, green, blue, white.
_SRGB_CHROMATICITIES = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)

_MIDDLE_GREY = 0.18
_WHITE_QUANTILE = 0.995
# The quantile of every third pixel of every third row is good enough for an exposure.
_STRIDE = 3

_PNG_FILTER_NONE = 8

LIVE_COMPRESSION = 0
"""Of a PNG that is replaced in a second: noise hardly compresses, and not trying is ten times cheaper."""

FINAL_COMPRESSION = 6

THUMBNAIL_EDGE = 160
"""Values: a list shows 72, screens have two for one, and a list of many must stay light."""


@dataclass(frozen=True, slots=True)
class Provenance:
    """What an image was made of, written into it."""

    scene_sha256: str
    schedule_json: str
    engine: int
    manifest: str = ""
    """Samples of each tile where not all have what the schedule ends with: see `manifest_text`."""
    floating_point_profile: str = ""
    """How all workers rounded."""
    quantity: str = ""
    """What Y measures; see nocturne_scene.quantities."""
    error_warning: str = ""
    """Why the errors are not to be trusted; empty: they are, as far as one image can tell."""
    truncated_paths: int = 0
    """Photons that a limit of the tracer ended, so that their light is missing."""
    way: str = ""
    """How the scene is traced and why, where a pilot chose."""
    warnings: tuple[RenderWarning, ...] = ()
    """What a pilot found that the image may not show."""
    wavelengths: WavelengthRange = VISIBLE
    """Those of the scene."""
    instruments: str = ""
    """What the sensor measures where, in metres, as JSON."""


def manifest_text(samples: Sequence[int]) -> str:
    """Samples of each tile, row by row, as "64x3 128 64": runs of equal numbers are shortened."""
    runs = [(value, len(list(run))) for value, run in groupby(samples)]
    return " ".join(f"{value}x{length}" if length > 1 else f"{value}" for value, length in runs)


def mean_xyz(sums: Sums, counts: Counts) -> Values:
    """Shape (height, width, 3); Y in cd/m2; 0 where there are no samples."""
    return sums[..., :3] / np.maximum(counts, 1)[..., None]


def tone_map(
    sums: Sums, counts: Counts, beside: npt.NDArray[np.floating[Any]] | None = None
) -> npt.NDArray[np.uint8]:
    """sRGB of shape (height, width, 3), exposed by the image itself, or as the one of Y `beside` it is.

    Reinhard, Stark, Shirley, Ferwerda: "Photographic Tone Reproduction for Digital Images" (2002), equations
    1, 2 and 4: the logarithmic mean of Y becomes middle grey, and much brighter pixels white.
    """
    xyz = sums[..., :3].astype(np.float32)
    samples = np.maximum(counts, 1).astype(np.float32)
    y = xyz[..., 1] / samples
    measured = y if beside is None else beside
    lit = measured[measured > 0.0]
    if lit.size == 0:
        return np.zeros(xyz.shape, dtype=np.uint8)
    exposure = _MIDDLE_GREY / float(np.exp(np.mean(np.log(lit), dtype=np.float64)))
    bright = float(np.quantile(measured[::_STRIDE, ::_STRIDE], _WHITE_QUANTILE))
    white = max(1.0, exposure * bright)
    y *= exposure
    scale = (exposure / samples) * (1.0 + y / white**2) / (1.0 + y)
    linear = xyz.reshape(-1, 3) @ _XYZ_TO_SRGB
    linear *= scale.astype(np.float32).reshape(-1, 1)
    steps = np.clip(linear, 0.0, 1.0, out=linear)
    steps *= _SRGB_STEPS
    encoded: npt.NDArray[np.uint8] = _SRGB_BYTES[(steps + 0.5).astype(np.uint16)]
    return encoded.reshape(xyz.shape)


def _srgb_curve(linear: Values) -> npt.NDArray[np.uint8]:
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.rint(encoded * 255.0).astype(np.uint8)


# The sRGB curve as a table: a power per channel would be half of a preview's cost. 2^14 steps are enough to
# tell dark bytes apart.
_SRGB_STEPS = 2**14
_SRGB_BYTES = _srgb_curve(np.linspace(0.0, 1.0, _SRGB_STEPS + 1))


def write_preview(
    path: Path,
    sums: Sums,
    counts: Counts,
    compression: int,
    beside: npt.NDArray[np.floating[Any]] | None = None,
) -> None:
    """Writes a tone-mapped PNG; `beside`: see `tone_map`."""
    pixels = tone_map(sums, counts, beside)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8")
    spec.attribute("png:compressionLevel", compression)
    if compression == LIVE_COMPRESSION:
        spec.attribute("png:filter", _PNG_FILTER_NONE)
    _write_png(path, spec, pixels)


def write_rgb_png(path: Path, pixels: npt.NDArray[np.uint8]) -> None:
    """Writes a PNG of bytes, shape (height, width, 3)."""
    _write_png(path, oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8"), pixels)


def srgb_to_xyz(linear: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """X, Y, Z of linear sRGB, shape (height, width, 3)."""
    xyz: npt.NDArray[np.float32] = linear @ np.linalg.inv(_XYZ_TO_SRGB)
    return xyz


def write_thumbnail(path: Path, sums: Sums, counts: Counts) -> None:
    """Writes a tone-mapped PNG of at most THUMBNAIL_EDGE pixels a side, each the mean of a square."""
    size = -(-max(counts.shape) // THUMBNAIL_EDGE)
    height, width = (max(1, edge // size) for edge in counts.shape)
    rows, columns = min(size, counts.shape[0]), min(size, counts.shape[1])
    area = (slice(height * rows), slice(width * columns))
    squares = (height, rows, width, columns)
    # Rows first: whole lines of memory are added, which is several times faster than both axes at once.
    lines = sums[area].reshape(height, rows, -1).sum(axis=1)
    small = lines.reshape(height, width, columns, -1)[..., :3].sum(axis=2)
    number = counts[area].reshape(squares).sum(axis=(1, 3), dtype=np.uint32)
    write_preview(path, small, number, FINAL_COMPRESSION)


def write_image(
    path: Path,
    sums: Sums,
    counts: Counts,
    squares: Squares,
    provenance: Provenance,
    further_responses: Sequence[str] = (),
    layers: Layers = NO_LAYERS,
) -> None:
    """Writes an EXR, as worker/src/image/write_exr.h does: all quantities, their errors and how these go
    together as float, n as uint; R, G, B for viewers; layers in addition."""
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        # Of R, G, B; X, Y, Z are CIE XYZ itself.
        "chromaticities": _SRGB_CHROMATICITIES,
        "nocturne:scene": provenance.scene_sha256,
        "nocturne:schedule": provenance.schedule_json,
        "nocturne:engine": provenance.engine,
        "nocturne:floatingPointProfile": provenance.floating_point_profile,
    }
    if provenance.manifest:
        header["nocturne:tileSamples"] = provenance.manifest
    header["nocturne:wavelengths"] = str(provenance.wavelengths)
    header |= _measured(provenance.quantity)
    header |= spectral_attributes(further_responses, quantity_named(provenance.quantity))
    if provenance.error_warning:
        header["nocturne:errorWarning"] = provenance.error_warning
    if provenance.way:
        header["nocturne:way"] = provenance.way
    header |= header_lines(provenance.warnings)
    if provenance.truncated_paths:
        header["nocturne:truncatedPaths"] = str(provenance.truncated_paths)
    # A sensor may have responses with such names: they go first.
    measured, correlations = _exr_channels(sums, counts, squares, further_responses)
    channels = {**layers.channels, **measured}
    if correlations is not None and (text := response_correlations.encode(correlations)):
        header[response_correlations.ATTRIBUTE] = text
    if provenance.instruments:
        header["nocturne:instruments"] = provenance.instruments
    try:
        with OpenEXR.File({**header, **layers.attributes}, channels) as file:
            file.write(str(path))
    except RuntimeError as trouble:
        raise OSError(f"can't write {path}: {trouble}") from trouble


def _measured(name: str) -> dict[str, Any]:
    """What the numbers are, and their units."""
    if not name:
        return {}
    quantity = quantity_named(name)
    attributes: dict[str, Any] = {
        "nocturne:quantity": quantity.name,
        "nocturne:unit": quantity.unit,
        "nocturne:responseUnit": quantity.response_unit,
    }
    if quantity is LUMINANCE:
        # OpenEXR's own: a luminance of 1 is 1 cd/m2.
        attributes["whiteLuminance"] = 1.0
    return attributes


_BAND_PIXELS = 2**20
"""Of an image of which channels are made at once: its moments take four times as much memory."""


def _exr_channels(
    sums: Sums, counts: Counts, squares: Squares, further_responses: Sequence[str]
) -> tuple[dict[str, npt.NDArray[Any]], Values | None]:
    """And the correlations of all values in each tile, as ImageMoments has them."""
    edge, (height, width) = squares.tile_size, counts.shape
    tiles = max(1, _BAND_PIXELS // (edge * width))
    channels: dict[str, npt.NDArray[Any]] = {}
    correlations: list[Values] = []
    for first in range(0, squares.of_tiles.shape[0], tiles):
        rows = slice(first * edge, (first + tiles) * edge)
        blocks = slice(first * edge // BLOCK, (first + tiles) * edge // BLOCK)
        of_band = Squares(squares.of_blocks[blocks], squares.of_tiles[first : first + tiles], edge)
        moments = moments_of(sums[rows], counts[rows], *of_band, further_responses)
        for name, values in _channels_of(moments, further_responses).items():
            channels.setdefault(name, np.empty((height, width), values.dtype))[rows] = values
        if moments.correlations is not None:
            correlations.append(moments.correlations)
    return channels, np.concatenate(correlations) if correlations else None


def _channels_of(moments: ImageMoments, further_responses: Sequence[str]) -> dict[str, npt.NDArray[Any]]:
    mean, errors = moments.mean.astype(np.float32), np.sqrt(moments.variance + moments.one_more)
    names = ["X", "Y", "Z", *further_responses]
    channels = {
        **planes(names, mean),
        **planes([f"{name}.stderr" for name in names], errors.astype(np.float32)),
        **planes(
            [f"{pair}.correlation" for pair in PAIRS],
            _correlation_of(moments.covariance, np.sqrt(moments.variance)),
        ),
        **_ratios(moments),
        "n": np.ascontiguousarray(moments.samples, dtype=np.uint32),
    }
    # A sensor may have responses with these names: they say more than what only viewers need.
    rgb = {} if channels.keys() & set("RGB") else planes("RGB", linear_srgb(mean[..., :3]))
    return {**channels, **rgb}


def _correlation_of(covariance: Values, errors: Values) -> npt.NDArray[np.float32]:
    """Of the errors of X and Y, X and Z, Y and Z; 0 where one of them has none."""
    both = errors[..., PAIR_FIRST] * errors[..., PAIR_SECOND]
    found = np.divide(covariance, both, out=np.zeros_like(both), where=both > 0.0)
    return np.clip(found, -1.0, 1.0).astype(np.float32)


def _ratios(moments: ImageMoments) -> dict[str, npt.NDArray[np.float32]]:
    """Variances of pixels by their own samples over what their errors say, of blocks over their pixels', and
    of tiles over their blocks', 1 without noise; and how X, Y, Z of blocks go together."""
    edge, (height, width) = moments.tile_size, moments.samples.shape
    of_blocks = moments.block_covariance[..., PRODUCTS_SQUARES]
    own = moments.variance[..., :3]
    own_ratio = _ratio(own, own + moments.one_more[..., :3])
    block_ratio = _ratio(of_blocks, block_sums(own))
    tile_ratio = _ratio(moments.tile_variance, tile_sums(of_blocks, edge))
    errors = np.sqrt(of_blocks)
    correlation = _correlation_of(moments.block_covariance[..., PRODUCTS_PAIRS], errors)
    found = {
        **{f"{name}.blockRatio": (block_ratio[..., index], BLOCK) for index, name in enumerate("XYZ")},
        **{f"{name}.ownRatio": (own_ratio[..., index], 1) for index, name in enumerate("XYZ")},
        **{f"{name}.tileRatio": (tile_ratio[..., index], edge) for index, name in enumerate("XYZ")},
        **{f"{name}.blockCorrelation": (correlation[..., index], BLOCK) for index, name in enumerate(PAIRS)},
    }
    return {
        name: np.ascontiguousarray(values.repeat(size, axis=0)[:height].repeat(size, axis=1)[:, :width])
        for name, (values, size) in found.items()
    }


def _ratio(variance: Values, independent: Values) -> npt.NDArray[np.float32]:
    ratio = np.divide(variance, independent, out=np.ones_like(variance), where=independent > 0.0)
    return ratio.astype(np.float32)


def linear_srgb(xyz: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """R, G, B with the bits of nocturne-trace: a matrix product's depend on the processor."""
    x, y, z = np.moveaxis(xyz, -1, 0)
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in _XYZ_TO_SRGB.T], axis=-1)


def planes(names: Sequence[str], pixels: npt.NDArray[np.float32]) -> dict[str, npt.NDArray[Any]]:
    """Channels of a file, from pixels that have them side by side."""
    return {name: np.ascontiguousarray(pixels[..., index]) for index, name in enumerate(names)}


def _write_png(path: Path, spec: oiio.ImageSpec, pixels: npt.NDArray[np.uint8]) -> None:
    output = oiio.ImageOutput.create("png")
    if output is None:
        raise OSError(f"can't write {path}: {oiio.geterror()}")
    if not (output.open(str(path), spec) and output.write_image(pixels) and output.close()):
        raise OSError(f"can't write {path}: {output.geterror()}")
