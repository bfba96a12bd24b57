"""The error of an EXR of ours by its own data: the estimate that the service makes, from the file alone."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import OpenEXR
from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate, estimate_error
from nocturne_coordinator.dispatch.trust import CONFIDENCE, error_warning_of
from nocturne_scene.compare.images import read_picture
from nocturne_scene.errors import InputError
from nocturne_scene.quantities import Quantity, quantity_named
from nocturne_scene.spectra.wavelength_range import VISIBLE
from nocturne_scene.uncertainty import ImageMoments, RegionReading, read_region

from nocturne_client.errors import NocturneClientError


@dataclass(frozen=True)
class ImageError:
    """An image's quantity, mean and error."""

    quantity: Quantity
    estimate: ErrorEstimate
    reading: RegionReading
    """Of the whole image."""
    wavelengths: str = ""
    """Of the scene, in words, where they are not the usual ones."""

    @property
    def error_warning(self) -> str:
        """Why the error is not to be trusted; empty: it is, as far as one image can tell."""
        return error_warning_of(self.estimate)

    def __str__(self) -> str:
        estimate, quantity = self.estimate, self.quantity
        if estimate.mean <= 0.0:
            return f"No light was found: all pixels are black after {estimate.samples} samples."
        what = "" if estimate.pixels == 1 else "mean "
        interval = f" +- {CONFIDENCE * estimate.mean_error:.2g}" if estimate.mean_error else ""
        of = f" of {self.wavelengths}" if self.wavelengths else ""
        mean = f"{what}{quantity.name or 'Y'}{of} {estimate.mean:.5g}{interval} {quantity.unit}".rstrip()
        if estimate.samples < 2:
            return f"{mean}; one sample per pixel gives no error."
        told = f"{mean}{self._colour()} (95 %), relative error {estimate.relative_error:.3%}"
        unseen = (
            f"; nothing seen in {estimate.zero_pixels:,} of {estimate.pixels:,} pixels"
            if estimate.zero_pixels
            else ""
        )
        doubtful = f"; the error is not to be trusted: {self.error_warning}" if self.error_warning else "."
        return told + unseen + doubtful

    def _colour(self) -> str:
        """u' and v' with their intervals; empty where these are not known."""
        if not self.quantity.has_colour:
            return ""
        parts = zip(("u'", "v'"), self.reading.chromaticity, self.reading.chromaticity_error, strict=True)
        told = [
            f", {name} {value:.4f} +- {CONFIDENCE * error:.2g}" for name, value, error in parts if error > 0.0
        ]
        return "".join(told)


def image_error(image: Path) -> ImageError:
    """Raises NocturneClientError where the file is none of ours."""
    try:
        with OpenEXR.File(str(image), header_only=True) as file:
            header = file.header()
            quantity = quantity_named(header.get("nocturne:quantity", ""))
            wavelengths = header.get("nocturne:wavelengths", str(VISIBLE)).removeprefix(str(VISIBLE))
        moments = read_picture(image).moments
    except (RuntimeError, KeyError, InputError) as error:
        raise NocturneClientError(f"{image} is no EXR of ours") from error
    reading = read_region(moments) if moments is not None else None
    if moments is None or reading is None:
        raise NocturneClientError(f"{image} is no EXR of ours")
    known = reading.samples_per_pixel[0] > 1
    estimate = replace(_estimate_of(moments), mean_error=reading.error[1] if known else 0.0)
    return ImageError(quantity, estimate, reading, wavelengths)


def _estimate_of(moments: ImageMoments) -> ErrorEstimate:
    """From sums that have these moments."""
    n = moments.samples.astype(np.float64)
    total = moments.mean[..., 1] * n
    squares = moments.variance[..., 1] * n * np.maximum(n - 1.0, 0.0) + total**2 / np.maximum(n, 1.0)
    return estimate_error(np.stack([total, total, total, squares], axis=-1), moments.samples)
