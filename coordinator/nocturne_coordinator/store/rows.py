"""Values that are read from and written to the data folder."""

from dataclasses import dataclass

from nocturne.v1 import job_pb2
from nocturne_scene.layers import known_layers
from nocturne_scene.ranges import PHOTON_BUNDLE
from nocturne_scene.render_warnings import RenderWarning
from nocturne_scene.spectra.wavelength_range import WavelengthRange

from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_coordinator.limits import DEFAULT_PRIORITY


@dataclass(frozen=True, slots=True)
class NewRender:
    """A render to be created; the scene is compiled already and its blobs are in the folder."""

    request_id: str
    name: str
    scene_sha256: str
    scene_document: str
    """JSON, as submitted."""
    width: int
    height: int
    samples: int
    schedule: job_pb2.RangeSchedule
    stop: StopConditions = EVERYTHING
    priority: int = DEFAULT_PRIORITY
    owner: str = ""
    """Name of the token that asked for it; empty without authentication."""
    floating_point_profile: str = ""
    """How its workers must round; empty: as the first one does."""
    warnings: tuple[RenderWarning, ...] = ()
    """What of the scene can hardly be meant, and what the image may not show."""
    way: str = ""
    """How it is traced and why; empty where no pilot chose."""
    sensor: str = ""
    """Its type in the scene document."""
    layers: tuple[str, ...] = ()
    layers_sha256: str = ""
    """Layers that were asked for, and the blob that holds all of the render's."""
    usual_layers: tuple[str, ...] = ()
    """Layers that it has without being asked for them, which are no part of the request."""
    in_group: str = ""
    after_group: str = ""
    """The group it was submitted with, and the one that has to end before it begins; see store/groups.py."""
    tags: tuple[str, ...] = ()
    """Words to sort renders by; see store/tags.py."""
    files: tuple[str, ...] = ()
    """Digests of the compiled scene's files, which must be there when the render is made."""
    further_files: tuple[str, ...] = ()
    """Of a replay, those of its original; see store/blob_use.py."""

    @property
    def all_layers(self) -> tuple[str, ...]:
        """Each once."""
        return known_layers((*self.layers, *self.usual_layers))


@dataclass(frozen=True, slots=True)
class RenderRow:
    """A render as the public service shows it; fields as in the messages Render and Progress."""

    id: str
    name: str
    state: RenderState
    reason: str
    width: int
    height: int
    samples: int
    photons_per_sample: int
    scene_sha256: str
    engine: int
    """Version of the tracing engine."""
    floating_point_profile: str
    """How all its workers round; empty before the first result."""
    sequence: int
    created: float
    started: float
    ended: float
    ranges_done: int
    ranges_planned: int
    photons: int
    rays: int
    invalid_samples: int
    quantity: str
    """What Y measures; see nocturne_scene.quantities."""
    wavelengths: WavelengthRange
    """Those of its scene."""
    warnings: tuple[RenderWarning, ...]
    """What of the scene can hardly be meant, and what the image may not show."""
    way: str
    """How it is traced and why; empty where no pilot chose."""
    sensor: str
    """Its type in the scene document."""
    layers: tuple[str, ...]
    layers_sha256: str
    """See NewRender."""
    in_group: str
    after_group: str
    """See NewRender."""
    tags: tuple[str, ...]
    """See NewRender."""
    truncated_paths: int
    photon_bundles: int
    """Forward photons in separate ranges: among all photons, but no samples of pixels."""
    relative_error: float
    top_percent_share: float
    effective_pixels: float
    mean: float
    mean_error: float
    zero_pixels: int
    """At the last preview; see error_estimate.ErrorEstimate."""
    error_warning: str
    """Why the error is not to be trusted; empty: it is."""
    photons_per_second: float
    cpu_seconds: float
    ran_seconds: float
    """Of running, pauses left out."""
    stop: StopConditions
    priority: int
    owner: str
    tiles: int
    tiles_done: int
    """Tiles that need no more samples."""
    tiles_failed: int
    audited: int
    """Ranges that were traced again elsewhere and were the same."""
    unaudited: int
    """Ranges that were to be audited, and that no other machine traced."""
    refused: int
    """Results that could not be right."""
    predicted_end: float
    """Unix time; 0 unknown."""
    predicted_cpu_seconds: float
    """In all; 0 unknown."""
    target_unreachable: str
    """Why the error asked for will not be reached in time, a sentence; empty: it will, or nobody knows."""
    look_first: str
    """JSON of a Region; empty: no part of the film goes first."""
    image_final: bool
    """An ended render's files hold all its committed samples (a cancelled one's follow within a second)."""

    @property
    def mean_samples(self) -> float:
        """Mean over pixels of samples merged."""
        samples = self.photons / self.photons_per_sample - self.photon_bundles * PHOTON_BUNDLE
        return samples / (self.width * self.height)


@dataclass(frozen=True, slots=True)
class TileChange:
    """A tile with committed samples, and the render's sequence when they were committed."""

    tile_index: int
    revision: int
    samples: int
    invalid_samples: int


@dataclass(frozen=True, slots=True)
class WorkerEvent:
    """A worker that joined, left or was put in quarantine."""

    unix_time: float
    worker_id: str
    what: str
    reason: str


@dataclass(frozen=True, slots=True)
class RatePoint:
    """What all workers together did at one time."""

    unix_time: float
    threads: int
    rays_per_second: float
