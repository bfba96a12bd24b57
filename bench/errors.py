"""Relative mean squared error: the squared error of a pixel over its own brightness, dark ones levelled."""

import numpy as np

from bench.programs import Channel

# Of the squared mean: pixels darker than a tenth of the mean count as if they were that bright.
_LEVEL = 0.01


def expected_relmse(error: Channel, reference: Channel) -> float:
    """From an image's own standard errors, right where samples are independent.

    The reference must not be the image itself: a pixel in which no photon found light would count as exact.
    """
    return float(np.mean(error**2 / _scale(reference)))


def true_relmse(image: Channel, reference: Channel, reference_error: Channel) -> float:
    """Against a reference with known standard errors, whose own share is taken off."""
    return float(np.mean(squared_errors(image, reference, reference_error)))


def squared_errors(image: Channel, reference: Channel, reference_error: Channel) -> Channel:
    """The same of each pixel."""
    errors: Channel = ((image - reference) ** 2 - reference_error**2) / _scale(reference)
    return errors


def trimmed_relmse(image: Channel, reference: Channel, reference_error: Channel, worst: float) -> float:
    """The same without a part of the pixels, in [0, 1): those with the largest errors."""
    errors = np.sort(squared_errors(image, reference, reference_error), axis=None)
    return float(np.mean(errors[: errors.size - round(worst * errors.size)]))


def _scale(image: Channel) -> Channel:
    scale: Channel = image**2 + _LEVEL * np.mean(image) ** 2
    return scale
