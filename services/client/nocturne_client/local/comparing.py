"""`nocturne compare` and `nocturne baseline`: how far two images are apart, and whether noise explains it."""

import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_scene.compare.agreement import Difference, Estimate, compare, compare_by_tiles
from nocturne_scene.compare.images import Picture, read_picture, write_difference
from nocturne_scene.errors import InputError
from nocturne_scene.photometry.polarisation import LinearPolarisation, polarisation_of
from nocturne_scene.uncertainty import read_region

from nocturne_client.client import Client
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.failures import client_errors
from nocturne_client.models import Render
from nocturne_client.readings import CONFIDENCE


@dataclass(frozen=True)
class Comparison:
    """What to compare, and how."""

    image: Path
    reference: Path
    variance: Path | None = None
    """Of one sample of a pixel of the reference."""
    reference_samples: float = 32_000
    """That the reference is the mean of; with `variance`."""
    samples: float | None = None
    """Of the image's pixels; None: as the file says."""
    scale: float = 1.0
    """The image's values are multiplied by this."""


@dataclass(frozen=True)
class Compared:
    """How far two images are apart."""

    difference: Difference
    names: tuple[str, ...]
    """Of the channels that were compared."""
    shift: tuple[float, float] | None = None
    """Of the images' mean chromaticity u', v', where the noise of both is known."""
    shift_error: tuple[float, float] = (0.0, 0.0)
    """Its standard error."""
    polarisation: tuple[LinearPolarisation, LinearPolarisation] | None = None
    """How the mean light of both is polarised, where both files tell."""
    silent: Path | None = None
    """The one file that does not state its errors; its noise is unknown."""

    @property
    def differs(self) -> bool:
        """Whether noise does not explain the difference; where a file has no errors, that of the means."""
        verdict, by_tiles = self.difference.verdict, self.difference.by_tiles
        if by_tiles is not None:
            return not by_tiles.means_agree
        return verdict is not None and not (verdict.pixels_agree and verdict.sums_agree)


def compare_files(comparison: Comparison, difference: Path | None) -> Compared:
    """Compare, and write a picture of the difference if asked to. Raises NocturneClientError."""
    with client_errors("the images can't be compared"):
        image, reference = read_picture(comparison.image), read_picture(comparison.reference)
        one, other, names = _estimates(comparison, image, reference)
        silent = _silent(comparison, one, other)
        try:
            found = compare(one, other) if silent is None else compare_by_tiles(one, other)
        except ValueError as error:
            raise InputError.at(str(comparison.image), str(error)) from None
        if difference is not None:
            write_difference(difference, image.xyz[..., 1] * comparison.scale, reference.xyz[..., 1])
    return Compared(found, names, *_shift(image, reference), _polarisation(image, reference), silent)


def _silent(comparison: Comparison, one: Estimate, other: Estimate) -> Path | None:
    """The file whose noise is unknown, if that of the other one is known."""
    if (one.variance is None) == (other.variance is None):
        return None
    return comparison.image if one.variance is None else comparison.reference


def _estimates(
    comparison: Comparison, image: Picture, reference: Picture
) -> tuple[Estimate, Estimate, tuple[str, ...]]:
    """With the variance of one sample of the reference: both images' noise is known from it, in all channels,
    as Mitsuba's tests do. Else all quantities that both files have with their errors, or Y if one of them has
    its standard error. Last, the names of the compared quantities."""
    scale, xyz = comparison.scale, ("X", "Y", "Z")
    if comparison.variance is None:
        if image.moments is not None and reference.moments is not None:
            common = (*xyz, *(name for name in image.names[3:] if name in reference.names))
            return _of_all(image, common, scale), _of_all(reference, common, 1.0), common
        if image.y_error is None and reference.y_error is None:
            return Estimate(image.xyz * scale), Estimate(reference.xyz), xyz
        return _of_y(image, scale), _of_y(reference, 1.0), ("Y",)
    of_sample = np.maximum(read_picture(comparison.variance).xyz, 0.0)
    if of_sample.shape != reference.xyz.shape:
        raise InputError.at(str(comparison.variance), "has another shape than the reference")
    samples = comparison.samples
    if samples is None:
        if image.samples is None:
            raise InputError.at(str(comparison.image), "says nothing of its samples; give --samples")
        samples = float(image.samples.mean())
    return (
        Estimate(image.xyz * scale, of_sample / samples),
        Estimate(reference.xyz, of_sample / comparison.reference_samples),
        xyz,
    )


def _of_all(picture: Picture, names: tuple[str, ...], scale: float) -> Estimate:
    assert picture.moments is not None  # noqa: S101 - asked before
    moments, places = picture.moments, [picture.names.index(name) for name in names]
    reading = read_region(moments)
    return Estimate(
        scale * moments.mean[..., places],
        scale**2 * moments.variance[..., places],
        _degrees(picture),
        reading.correlation if reading else 1.0,
    )


def _shift(image: Picture, reference: Picture) -> tuple[tuple[float, float] | None, tuple[float, float]]:
    """By how much the mean chromaticity differs, and the standard error of that."""
    found = [read_region(each.moments) for each in (image, reference) if each.moments is not None]
    readings = [each for each in found if each is not None and each.mean[1] > 0.0]
    if len(readings) < 2:
        return None, (0.0, 0.0)
    one, other = readings
    u, v = (a - b for a, b in zip(one.chromaticity, other.chromaticity, strict=True))
    errors = zip(one.chromaticity_error, other.chromaticity_error, strict=True)
    u_error, v_error = (math.hypot(a, b) for a, b in errors)
    return (u, v), (u_error, v_error)


def _polarisation(image: Picture, reference: Picture) -> tuple[LinearPolarisation, LinearPolarisation] | None:
    found = []
    for picture in (image, reference):
        reading = read_region(picture.moments) if picture.moments is not None else None
        found.append(None if reading is None else polarisation_of(reading, picture.names))
    one, other = found
    return None if one is None or other is None else (one, other)


def _degrees(picture: Picture) -> float:
    return np.inf if picture.samples is None else max(1.0, float(picture.samples.min()) - 1)


def _of_y(picture: Picture, scale: float) -> Estimate:
    y = scale * picture.xyz[..., 1:2]
    if picture.y_error is None:
        return Estimate(y)
    return Estimate(y, (scale * picture.y_error[..., None]) ** 2, _degrees(picture))


def as_json(compared: Compared) -> dict[str, Any]:
    """For programs."""
    found = compared.difference
    values: dict[str, Any] = {"relmse": found.relmse, "trimmed_relmse": found.trimmed_relmse}
    values["channels"], values["ratio"] = list(compared.names), found.ratio.tolist()
    if compared.shift is not None:
        values["chromaticity_shift"] = list(compared.shift)
        values["chromaticity_shift_error"] = list(compared.shift_error)
    if compared.polarisation is not None:
        values["linear_polarisation"] = [
            {
                "degree": each.degree,
                "degree_interval": list(each.degree_interval),
                "angle_degrees": each.angle_degrees,
                "angle_error_degrees": each.angle_error,
            }
            for each in compared.polarisation
        ]
    if found.ratio_error is not None:
        values["ratio_error"] = found.ratio_error.tolist()
    if found.by_tiles is not None:
        values["without_errors"] = str(compared.silent)
        values["mean_z"] = found.by_tiles.mean_z.tolist()
        values["explained"], values["means_agree"] = found.by_tiles.explained, found.by_tiles.means_agree
    if found.verdict is not None:
        verdict = found.verdict
        values["share_explained"] = verdict.share_explained
        values["mean_z"] = verdict.mean_z.tolist()
        values["pixels_agree"], values["sums_agree"] = verdict.pixels_agree, verdict.sums_agree
    return values


def as_lines(compared: Compared) -> list[str]:
    """For people."""
    found = compared.difference
    lines = [f"relMSE {found.relmse:.4g}, without the largest thousandth {found.trimmed_relmse:.4g}"]
    for index, name in enumerate(compared.names):
        line = f"mean {name}: {found.ratio[index] - 1:+.3%} of the reference's"
        known = found.verdict or found.by_tiles
        if found.ratio_error is not None and known is not None:
            half = CONFIDENCE * found.ratio_error[index]
            line += f" +- {half:.3%} (95 %; z {known.mean_z[index]:+.1f})"
        lines.append(line)
    if compared.shift is not None:
        shifts = zip(("u'", "v'"), compared.shift, compared.shift_error, strict=True)
        told = ", ".join(f"{name} {shift:+.5f} +- {CONFIDENCE * error:.5f}" for name, shift, error in shifts)
        lines.append(f"mean chromaticity off by {told} (95 %)")
    if compared.polarisation is not None:
        lines.append("linearly polarised " + ", the reference's ".join(map(_told, compared.polarisation)))
    if found.by_tiles is not None:
        agree = "agree" if found.by_tiles.means_agree else "differ by more than noise"
        return [
            *lines,
            f"{compared.silent} does not state its errors: "
            "the interval is from the scatter of tiles, and pixels are not judged",
            f"stated errors explain {found.by_tiles.explained:.0%} of the squared difference of pixels; "
            "the rest is noise of that file, or a difference",
            f"means {agree}",
        ]
    if found.verdict is None and compared.silent is not None:
        return [
            *lines,
            f"{compared.silent} does not state its errors, and the images are too small to estimate them",
        ]
    if found.verdict is None:
        return [*lines, "neither file tells its noise, so nothing can be said about chance"]
    verdict = found.verdict
    lines.append(f"pixels within their bound: {verdict.share_explained:.2%}; expected 99.75 % or more")
    lines.append(f"tiles and means {'agree' if verdict.sums_agree else 'differ by more than noise'}")
    return lines


def _told(found: LinearPolarisation) -> str:
    low, high = found.degree_interval
    angle = f"at {found.angle_degrees:.1f} +- {found.angle_error:.1f} degrees"
    return f"by {found.degree:.4g} ({low:.4g} to {high:.4g}) {angle}"


def compared_with_baseline(
    url: str | None, render_id: str, engine: int, difference: Path | None
) -> tuple[str, Compared]:
    """The compared renders in words, and how far both are apart. `engine`: 0 for the newest other one.

    Raises NocturneClientError.
    """
    with Client(url) as client, tempfile.TemporaryDirectory(prefix="nocturne-baseline-") as folder:
        render = client.get(render_id)
        other = _chosen([*client.baselines(render.id)], render, engine)
        one, reference = Path(folder) / "image.exr", Path(folder) / "baseline.exr"
        client.download(render.id, "exr", one)
        client.download(other.id, "exr", reference)
        told = f"{render.id} by engine {render.engine}, beside {other.id} by engine {other.engine}"
        return told, compare_files(Comparison(one, reference), difference)


def _chosen(baselines: list[Render], render: Render, engine: int) -> Render:
    found = next((each for each in baselines if engine in (0, each.engine)), None)
    if found is None:
        wanted = f"engine {engine}" if engine else f"another engine than {render.engine}"
        raise NocturneClientError(f"there is no image of the same scene and film by {wanted}")
    return found
