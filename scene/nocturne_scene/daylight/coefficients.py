"""Daylight coefficients, and illuminances of hours from them.

P. Tregenza, I. Waters, "Daylight coefficients", Lighting Research and Technology 15 (1983) 65.

A coefficient is what a patch of luminance 1 brings to a point. They are means of independent batches of
photons, and so is all that is linear in them. The Sun comes straight from its disc, hour by hour, and by
surfaces from finer patches around it, for which photons are aimed at the Sun's patches alone.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight.year_of_skies import YearOfSkies
from nocturne_scene.spectra.published import Floats

_SPREAD = 2.0
"""Of the Sun's light that comes via surfaces, in heights of a patch's row to each side."""


@dataclass(frozen=True)
class Layout:
    """Which patches coefficients are of."""

    sky: Patches
    suns: Patches
    """Finer ones, for the Sun via surfaces."""

    def sunny(self, skies: YearOfSkies) -> NDArray[np.intp]:
        """The patches that the Sun is in at some hour of the year, increasing."""
        return np.unique(self.suns.numbers(skies.sun_towards[skies.sunny]))

    def around_suns(self, skies: YearOfSkies) -> Floats:
        """By sunny hour and sunny patch, which parts of the Sun's light come from patches around it, 1/sr.

        What surfaces bring of it hardly changes over some degrees, and a patch alone has met few photons.
        """
        sunny = self.sunny(skies)
        middles = self.suns.points[sunny - 1].mean(axis=1)
        middles /= np.linalg.norm(middles, axis=1, keepdims=True)
        towards = skies.sun_towards[skies.sunny]
        angle = np.arccos(np.clip(towards @ middles.T, -1.0, 1.0))
        angles = self.suns.solid_angles[sunny]
        weights = np.maximum(0.0, 1.0 - (angle / (_SPREAD * self.suns.height)) ** 2) * angles
        return np.asarray(weights / weights.sum(axis=1, keepdims=True) / angles)


@dataclass(frozen=True)
class Coefficients:
    """Sums over samples."""

    sky: Floats
    """By batch, point and patch of the sky, lx for cd/m2."""
    reflected: Floats
    """By batch, point and sunny patch: by all paths but those straight through windows."""
    suns: Floats
    """By batch, point and sunny hour: straight from a Sun of illuminance 1 across its beam."""
    across: Floats
    """By batch and point, of the samples of `suns`: what that illuminance was, by the drawn wavelengths."""
    samples: int
    """Of `sky` and `reflected`, of each batch."""

    def __add__(self, more: "Coefficients") -> "Coefficients":
        """With further samples of the patches."""
        return Coefficients(
            self.sky + more.sky,
            self.reflected + more.reflected,
            self.suns,
            self.across,
            self.samples + more.samples,
        )

    def side_by_side(self) -> "Coefficients":
        """In the usual order in memory."""
        sky, reflected = np.ascontiguousarray(self.sky), np.ascontiguousarray(self.reflected)
        return Coefficients(
            sky, reflected, np.ascontiguousarray(self.suns), np.ascontiguousarray(self.across), self.samples
        )

    @property
    def points(self) -> int:
        """How many."""
        return int(self.sky.shape[1])

    def of_points(self, which: slice | NDArray[np.intp]) -> "Coefficients":
        """Those of some points."""
        return Coefficients(
            self.sky[:, which],
            self.reflected[:, which],
            self.suns[:, which],
            self.across[:, which],
            self.samples,
        )


@dataclass(frozen=True)
class Illuminances:
    """By batch, point and hour, lx."""

    whole: Floats
    sun: Floats
    """Straight from the Sun alone."""


def illuminances(coefficients: Coefficients, skies: YearOfSkies, layout: Layout) -> Illuminances:
    """Of all hours of some points. Equal coefficients give equal bits, however they lie in memory."""
    coefficients = coefficients.side_by_side()
    whole = (coefficients.sky / coefficients.samples) @ skies.luminances.T
    sunny = skies.sunny
    sun = np.zeros_like(whole)
    if len(sunny):
        lux = skies.sun_illuminance[sunny]
        reflected = (coefficients.reflected / coefficients.samples) @ layout.around_suns(skies).T
        # A batch has few wavelengths; what all of them are together is 1.
        white = coefficients.across.mean(axis=0)[..., None]
        sun[..., sunny] = coefficients.suns / np.where(white > 0, white, 1.0) * lux
        whole[..., sunny] += reflected * lux + sun[..., sunny]
    return Illuminances(whole, sun)


BLINDS_LUX, BLINDS_POINTS = 1000.0, 0.02
"""IES LM-83-12: blinds are closed in hours in which more than this part of the points has more lux than that
straight from the Sun."""


def hours_of_sun(coefficients: Coefficients, skies: YearOfSkies) -> NDArray[np.bool_]:
    """In which of the hours with light blinds are closed."""
    closed = np.zeros(len(skies.hours), dtype=bool)
    sunny = skies.sunny
    if len(sunny):
        white = coefficients.across.mean(axis=0)[:, None]
        straight = coefficients.suns.mean(axis=0) / np.where(white > 0, white, 1.0)
        lit = straight * skies.sun_illuminance[sunny] > BLINDS_LUX
        closed[sunny] = lit.mean(axis=0) > BLINDS_POINTS
    return closed


def with_blinds(opened: Illuminances, closed: Illuminances, hours: NDArray[np.bool_]) -> Illuminances:
    """Of a room whose blinds are closed in some of the hours. The Sun's own light is that of open blinds: by
    LM-83-12 sunlight exposure is without them."""
    return Illuminances(np.where(hours, closed.whole, opened.whole), opened.sun)
