"""Forward photons of a film, which fall on any tile: their accumulator, and what tiles show of it. Pure.

The queue of their ranges is published together with those of tiles (`range_queue.py`).
"""

from nocturne_scene.photon_sums import with_photons
from nocturne_scene.ranges import PHOTON_BUNDLE, ratio_of, samples_by
from nocturne_scene.tile_sums import TileSums

from nocturne_coordinator.dispatch.film_sums import FilmSums
from nocturne_coordinator.dispatch.merge import Accumulator
from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.limits import photon_ranges_ahead

_COMMIT_SECONDS = (2.0, 30.0)
_PIXELS_A_SECOND = 2**14


class ForwardPhotons:
    """Sums of forward photons over the whole film. A tile is shown with the sums of these and of its
    own samples, which are none where forward photons bring all light."""

    def __init__(self, render: PlannedRender) -> None:
        self._render = render
        self._sums = FilmSums.zeros(render.grid, render.further)
        self.merged = Accumulator(self._sums.whole, photon_ranges_ahead(render.pixels))

    def replan(self, render: PlannedRender) -> None:
        """Goes on by another schedule, which begins with the ranges that are merged."""
        self._render = render

    @property
    def bundles(self) -> int:
        return self._render.photon_ranges.end_of(self.merged.merged)

    def tile(self, tile_index: int) -> TileSums:
        """Views of what fell on a tile."""
        return self._sums.tile(tile_index)

    def samples_shown(self, samples: int) -> int:
        """Of a tile with so many adjoint samples. None before both kinds have come: half of the light would
        look like an image."""
        if not self.bundles:
            return 0
        return samples if self._render.ranges else samples_by(self.bundles, self._render.pixels)

    def with_own(self, tile_index: int, own: TileSums, samples: int) -> TileSums | None:
        """A tile's sums of both kinds; None: there is nothing to show yet."""
        shown = self.samples_shown(samples)
        if not shown:
            return None
        return with_photons(own, shown, self.tile(tile_index), self.bundles, self._render.pixels)

    def are_as_many_as(self, samples: int) -> bool:
        """Whether so many samples of each pixel have no more photons than there are of these."""
        wanted = samples * self._render.pixels * ratio_of(self._render.schedule)
        return self.bundles * PHOTON_BUNDLE >= wanted


def photon_commit_seconds(pixels: int) -> float:
    """Between two commits of forward photons: they write sums of the whole film three times, which a small
    one is soon done with."""
    least, most = _COMMIT_SECONDS
    return min(most, max(least, pixels / _PIXELS_A_SECOND))
