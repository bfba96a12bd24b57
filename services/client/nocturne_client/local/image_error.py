"""What an EXR of ours says of its own error: the estimate that the service makes, from the file alone."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR
from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate, estimate_error
from nocturne_coordinator.dispatch.trust import CONFIDENCE, doubt_of
from nocturne_scene.quantities import Quantity, quantity_named

from nocturne_client.errors import NocturneClientError


@dataclass(frozen=True)
class ImageError:
    """An image's quantity, mean and error."""

    quantity: Quantity
    estimate: ErrorEstimate

    @property
    def doubt(self) -> str:
        """Why the error is not to be trusted; empty: it is, as far as one image can tell."""
        return doubt_of(self.estimate)

    def __str__(self) -> str:
        estimate, quantity = self.estimate, self.quantity
        if estimate.mean <= 0.0:
            return f"No light was found: all pixels are black after {estimate.samples} samples."
        what = "" if estimate.pixels == 1 else "mean "
        interval = f" +- {CONFIDENCE * estimate.mean_error:.2g}" if estimate.mean_error else ""
        mean = f"{what}{quantity.name or 'Y'} {estimate.mean:.5g}{interval} {quantity.unit}".rstrip()
        told = f"{mean} (95 %), relative error {estimate.relative_error:.3%}"
        unseen = (
            f"; nothing seen in {estimate.unseen_pixels:,} of {estimate.pixels:,} pixels"
            if estimate.unseen_pixels
            else ""
        )
        doubt = f"; the error is not to be trusted: {self.doubt}" if self.doubt else "."
        return told + unseen + doubt


def image_error(image: Path) -> ImageError:
    """Raises NocturneClientError where the file is none of ours."""
    try:
        with OpenEXR.File(str(image), separate_channels=True) as file:
            channels = file.channels()
            quantity = quantity_named(file.header().get("nocturne:quantity", ""))
            found = [np.asarray(channels[name].pixels, dtype=np.float64) for name in ("Y", "Y.stderr", "n")]
    except (RuntimeError, KeyError) as error:
        raise NocturneClientError(f"{image} is no EXR of ours") from error
    y, error_of_y, n = found
    total = y * n
    squares = error_of_y**2 * n * np.maximum(n - 1.0, 0.0) + total**2 / np.maximum(n, 1.0)
    sums = np.stack([total, total, total, squares], axis=-1)
    estimate = estimate_error(sums, n.astype(np.uint32))
    return ImageError(quantity, estimate)
