"""`nocturne compare`: how far two images are apart, and whether noise explains it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_scene.compare.agreement import Difference, Estimate, compare
from nocturne_scene.compare.images import Picture, read_picture, write_difference
from nocturne_scene.errors import InputError

from nocturne_client.errors import NocturneClientError, Problem


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


def compare_files(comparison: Comparison, difference: Path | None) -> Difference:
    """Compare, and write a picture of the difference if asked to. Raises NocturneClientError."""
    try:
        image, reference = read_picture(comparison.image), read_picture(comparison.reference)
        one, other = _estimates(comparison, image, reference)
        try:
            found = compare(one, other)
        except ValueError as error:
            raise InputError.at(str(comparison.image), str(error)) from None
        if difference is not None:
            write_difference(difference, image.xyz[..., 1] * comparison.scale, reference.xyz[..., 1])
    except InputError as error:
        problems = [Problem(each.place, each.message) for each in error.problems]
        raise NocturneClientError("the images can't be compared", problems=problems) from error
    return found


def _estimates(comparison: Comparison, image: Picture, reference: Picture) -> tuple[Estimate, Estimate]:
    """With the variance of one sample of the reference: both images' noise is known from it, in all channels,
    as Mitsuba's tests do. Else Y is compared if one of the files has its standard error."""
    scale = comparison.scale
    if comparison.variance is None:
        if image.y_error is None and reference.y_error is None:
            return Estimate(image.xyz * scale), Estimate(reference.xyz)
        return _of_y(image, scale), _of_y(reference, 1.0)
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
    )


def _of_y(picture: Picture, scale: float) -> Estimate:
    y = scale * picture.xyz[..., 1:2]
    if picture.y_error is None:
        return Estimate(y)
    degrees = np.inf if picture.samples is None else max(1.0, float(picture.samples.min()) - 1)
    return Estimate(y, (scale * picture.y_error[..., None]) ** 2, degrees)


def as_json(found: Difference) -> dict[str, Any]:
    """For programs."""
    values: dict[str, Any] = {"relmse": found.relmse, "trimmed_relmse": found.trimmed_relmse}
    values["ratio"] = found.ratio.tolist()
    if found.ratio_error is not None:
        values["ratio_error"] = found.ratio_error.tolist()
    if found.verdict is not None:
        verdict = found.verdict
        values["share_explained"] = verdict.share_explained
        values["mean_z"] = verdict.mean_z.tolist()
        values["pixels_agree"], values["sums_agree"] = verdict.pixels_agree, verdict.sums_agree
    return values


def as_lines(found: Difference) -> list[str]:
    """For people."""
    names = "XYZ" if len(found.ratio) == 3 else "Y"
    lines = [f"relMSE {found.relmse:.4g}, without the largest thousandth {found.trimmed_relmse:.4g}"]
    for index, name in enumerate(names):
        line = f"mean {name}: {found.ratio[index] - 1:+.3%} of the reference's"
        if found.ratio_error is not None and found.verdict is not None:
            line += f" +- {found.ratio_error[index]:.3%} (z {found.verdict.mean_z[index]:+.1f})"
        lines.append(line)
    if found.verdict is None:
        return [*lines, "neither file tells its noise, so nothing can be said about chance"]
    verdict = found.verdict
    lines.append(f"pixels within their bound: {verdict.share_explained:.2%}; expected 99.75 % or more")
    lines.append(f"tiles and means {'agree' if verdict.sums_agree else 'differ by more than noise'}")
    return lines
