"""The service's answers as values. Made from docs/reference/openapi.json by generate_models.py."""

from dataclasses import dataclass
from typing import Any, Literal

RenderState = Literal[
    "QUEUED",
    "RUNNING",
    "PAUSED",
    "SUCCEEDED",
    "STOPPED_EARLY",
    "DEGRADED",
    "FAILED",
    "CANCELLED",
]
"""Where a render stands; from SUCCEEDED on it has ended, though it may be extended."""


WarningKind = Literal[
    "scene",
    "layers",
    "missing_light",
    "missing_in_parts",
    "fault",
]
"""What a warning is about."""


@dataclass(frozen=True)
class UnmetPart:
    """Pixels [x, x + width) times [y, y + height), from the upper left corner, in which light may be
    missing that no error shows.
    """

    x: int
    y: int
    width: int
    height: int
    part: float
    """At most so much (two standard errors above what a pilot found), relative to the light seen there."""


@dataclass(frozen=True)
class RenderWarning:
    """A warning to readers of a render, in addition to its error."""

    kind: WarningKind
    """scene: the document says what can hardly be meant. layers: they could not be made. missing_light: so
    much of the image's mean may be missing. missing_in_parts: light may be missing in parts of the
    image. fault: of the program.
    """
    sentence: str
    parts: list[UnmetPart]
    """Of missing_in_parts: all pixels in which light may be missing."""


@dataclass(frozen=True)
class StopConditions:
    """When a render ends besides at its last sample: at the first that is met. 0 or empty: not asked for."""

    relative_error: float
    """Of the image, as in Progress."""
    tile_relative_error: float
    """Of each tile, from its own pixels; a tile that has it gets no more samples."""
    wall_seconds: float
    """Seconds of running, without pauses."""
    cpu_seconds: float
    """Processor seconds of workers."""
    until: str
    """A time with its zone, as it was given."""
    until_time: float
    """The same as Unix time."""


@dataclass(frozen=True)
class Region:
    """Pixels [x, x + width) times [y, y + height), from the upper left corner."""

    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True)
class Progress:
    """The merged and committed work of a render."""

    ranges_done: int
    """Sample ranges merged."""
    ranges_planned: int
    """Sample ranges of the whole render."""
    samples_merged: int
    """Samples merged, of all pixels together."""
    rays: int
    """Rays cast for them."""
    invalid_samples: int
    """Contributions left out because they were NaN, infinite or negative."""
    truncated_paths: int
    """Photons ended by the tracer's limit of interactions; light that they would have brought is missing."""
    mean_samples: float
    """Mean over pixels of the samples merged."""
    relative_error: float
    """Root mean square over pixels of Y's standard error relative to Y, sqrt(mean(var / (Y^2 + 0.01 M^2)))
    with M the image's mean Y; 0: unknown.
    """
    top_percent_share: float
    """Part of the square of relative_error that the worst 1 % of the pixels have; 0: unknown."""
    effective_pixels: float
    """Effective sample size (Kish) of the pixels that carry the error, (sum v)^2 / sum v^2 of their
    relative variances; 0: unknown.
    """
    mean: float
    """Mean of Y over pixels, in the render's unit; 0: unknown."""
    mean_error: float
    """Standard error of the mean; its 95 % interval is 1.96 of it to each side."""
    zero_pixels: int
    """Pixels in which no sample found any light: nothing is known of them but that it is rare."""
    error_warning: str
    """Why relative_error is not to be trusted, a sentence; empty: it is, as far as one image can tell."""
    samples_per_second: float
    """Rate of the last minutes; 0 when nothing comes back."""
    rays_per_second: float
    """The same in rays."""
    cpu_seconds: float
    """Processor seconds spent by workers."""
    tiles_done: int
    """Tiles that need no more samples."""
    tiles: int
    """Tiles of the film."""
    tiles_failed: int
    """Tiles that were given up after failing on several workers."""
    audited: int
    """Ranges that another worker traced again with the same result."""
    unaudited: int
    """Ranges that were chosen to be traced again, and that no other machine has traced by now."""
    refused: int
    """Results that were refused because they could not be right."""
    predicted_end: float
    """Unix time at which the render should end, from its rate and error so far; 0: unknown."""
    predicted_cpu_seconds: float
    """Processor seconds that it should have cost by then; 0: unknown."""


@dataclass(frozen=True)
class Render:
    """One render."""

    id: str
    name: str
    state: RenderState
    reason: str
    """Why it is in this state, in words; may be empty."""
    width: int
    """Pixels."""
    height: int
    """Pixels."""
    samples: int
    """Samples per pixel asked for, at most."""
    scene_sha256: str
    """SHA-256 of the compiled scene, hexadecimal."""
    engine: int
    """Version of the tracing engine that its samples are by."""
    floating_point_profile: str
    """How its workers round, which all do alike; empty before the first result."""
    quantity: str
    """What Y measures: "luminance", "illuminance" or "luminous intensity", or what the sensor measures
    instead, such as "irradiance"; empty: not kept, in renders of older programs.
    """
    unit: str
    """Unit of Y, such as "cd/m2", "lx", "cd" or "W m-2"."""
    response_unit: str
    """Unit of further responses, for one without a unit: "W m-2 sr-1", "W m-2" or "W sr-1"."""
    first_nm: float
    """The shortest of the scene's wavelengths, nm: 360 unless it says another."""
    last_nm: float
    """The longest of them, nm: 830 unless it says another."""
    warnings: list[RenderWarning]
    """What of the scene can hardly be meant, with its place, and what the image may not show."""
    way: str
    """How it is traced and why, in words: what a pilot chose. Empty: the scene left nothing open, or the
    render is too small for a pilot.
    """
    sensor: str
    """Type of the scene's sensor, such as "panorama", of which glare can be rated; "daylight" for meters
    that measure daylight coefficients.
    """
    guided: bool
    """Whether photons from the sensor are sent to where light was learned to come from."""
    layers: list[str]
    """Layers that its EXR has in addition to the image: those asked for, and emission of a panorama."""
    group: str
    """Name of its group; empty: none."""
    after: str
    """The group that has to end before it begins; empty: none."""
    tags: list[str]
    """Words to sort renders by."""
    target_unreachable: str
    """Why the error asked for will not be reached before a time ends the render, a sentence, by its rate
    so far; empty: it will, or nobody knows.
    """
    sequence: int
    """Grows with every change that watchers should see."""
    created: float
    """Unix time, seconds."""
    started: float
    """Unix time, seconds; 0 before the start."""
    ended: float
    """Unix time, seconds; 0 before the end."""
    stop: StopConditions
    priority: int
    """1 to 1000: the render's weight among those of its owner."""
    owner: str
    """Name of the token that asked for it; empty without authentication."""
    look_first: Region | None
    """The part of the film that gets its samples first; null: all parts are alike."""
    progress: Progress


@dataclass(frozen=True)
class Explanation:
    """What a render waits for."""

    sentence: str


@dataclass(frozen=True)
class ReadValue:
    """A mean and its error."""

    name: str
    """X, Y, Z, or a further response of the sensor."""
    mean: float
    standard_error: float | None
    """Of the mean; null where it is not known."""


@dataclass(frozen=True)
class LinearPolarisation:
    """How the mean light is polarised."""

    degree: float
    """Of linear polarisation, in [0, 1]: sqrt(S1^2 + S2^2) / S0 less the noise."""
    degree_interval: list[float]
    """Low and high end of the 95 % interval; empty where errors are not known."""
    angle_degrees: float
    """From the sensor's right towards up, in [0, 180)."""
    angle_error: float | None
    """Half of the 95 % interval, degrees; 90: nothing is known of it; null where errors are not known."""


@dataclass(frozen=True)
class Reading:
    """Means over the pixels of a region that have samples."""

    region: Region
    quantity: str
    """What Y measures; empty where it is not known."""
    unit: str
    """Of X, Y and Z."""
    response_unit: str
    """Of a further response without its own unit."""
    values: list[ReadValue]
    """X, Y, Z, then the sensor's further responses by name."""
    u_prime: float | None
    """CIE 1976 u' of the mean; null in the dark."""
    v_prime: float | None
    """CIE 1976 v' of the mean; null in the dark."""
    u_prime_error: float | None
    """Standard error; null where it is not known."""
    v_prime_error: float | None
    """Standard error; null where it is not known."""
    correlation: float
    """How many times the variance of Y is that of pixels that know nothing of each other; at least 1."""
    coverage_factor: float | None
    """Standard errors to each side of a 95 % interval: Student's t, 2.13 for a block with 16 samples, 1.96
    where errors are well known; null where they are not known.
    """
    pixels: int
    zero_pixels: int
    """In which no sample found light."""
    samples: int
    """Of all pixels together."""
    fewest_samples: int
    """Of any pixel."""
    most_samples: int
    """Of any pixel."""
    invalid_samples: int
    """Of the tiles that the region touches."""
    linear_polarisation: LinearPolarisation | None
    """Of Y, where the sensor has `stokes` and there is light."""


@dataclass(frozen=True)
class Outline:
    """A part of the film."""

    name: str
    kind: str
    points: list[list[float]]
    """[x, y] in pixels from the film's upper left corner, where pixel i covers [i, i + 1). Two opposite
    corners of a rectangle; 3 to 256 corners of a polygon; of a line its first and last pixel, [0, 0]
    being the film's first one.
    """


@dataclass(frozen=True)
class PixelValue:
    """What one pixel shows."""

    x: int
    y: int
    value: float
    standard_error: float | None
    """Standard error; null where it is not known."""
    place: list[float] | None
    """The middle of a meter's pixel, x, y, z in metres; null of other sensors."""


@dataclass(frozen=True)
class Histogram:
    """How many pixels have which values."""

    edges: list[float]
    """Where bins begin and end: one more than there are counts."""
    counts: list[int]
    outside: int
    """Pixels below the first bin or above the last."""
    logarithmic: bool


@dataclass(frozen=True)
class ColourValue:
    """A number of the colour of the arriving light."""

    name: str
    """Such as Ra, Rf, melanopic equivalent daylight illuminance."""
    value: float | None
    """Null where the light has none."""
    standard_error: float | None
    """Standard error; null where it is not known."""
    unit: str
    """In ASCII; empty: none."""


@dataclass(frozen=True)
class DaylightFactor:
    """Illuminance over that outdoors, in percent (EN 17037)."""

    mean: float
    mean_error: float | None
    """Standard error; null where it is not known."""
    minimum: float
    minimum_error: float | None
    """Standard error; null where it is not known."""


@dataclass(frozen=True)
class Measurement:
    """One quantity over the pixels of an outline that have samples; the extremes are those of single
    pixels.
    """

    outline: Outline
    pixels: int
    zero_pixels: int
    """In which no sample found light."""
    mean: float
    mean_error: float | None
    """Standard error; null where it is not known."""
    minimum: PixelValue
    maximum: PixelValue
    u0: float | None
    """Uniformity, minimum over mean; null in the dark."""
    u0_error: float | None
    """Standard error; null where it is not known."""
    ud: float | None
    """Minimum over maximum; null in the dark."""
    ud_error: float | None
    """Standard error; null where it is not known."""
    profile: list[PixelValue]
    """Of a line: its pixels in order."""
    profile_csv: str
    """The same as a table (RFC 4180); empty for other outlines."""
    histogram: Histogram | None
    """Where one was asked for."""
    colour: list[ColourValue]
    """Of the light, where it was asked for and is known."""
    daylight_factor: DaylightFactor | None
    """Of meters whose sensor names an instrument outdoors."""
    linear_polarisation: LinearPolarisation | None
    """Of the channel, where the sensor has `stokes` and there is light."""


@dataclass(frozen=True)
class Measurements:
    """What outlines of an image show."""

    quantity: str
    """The measured quantity; the channel's name where it is not Y."""
    unit: str
    channel: str
    measurements: list[Measurement]
    """In the order of the outlines."""
    csv: str
    """The same as a table (RFC 4180), without profiles and histograms."""


@dataclass(frozen=True)
class Isoline:
    """Lines along which the image has one value."""

    level: float
    lines: list[list[list[float]]]
    """Points [x, y] in pixels from the film's upper left corner; closed, or from border to border."""


@dataclass(frozen=True)
class Isolines:
    """Lines along which the image has these values, of means over blocks of pixels."""

    quantity: str
    unit: str
    block: int
    """Edge of a block in pixels."""
    isolines: list[Isoline]
    """Lowest level first."""


@dataclass(frozen=True)
class GlareSource:
    """Connected pixels that glare."""

    luminance: float
    """Mean over its solid angle, cd/m2."""
    solid_angle: float
    """sr."""
    position_index: float
    azimuth_degrees: float
    """To the right of the line of sight."""
    elevation_degrees: float
    """Above the line of sight."""


@dataclass(frozen=True)
class Glare:
    """How much an eye is disturbed by what a panorama shows."""

    ugr: float | None
    """Unified glare rating, CIE 117; null where it is not known: `notes` say why."""
    ugr_error: float | None
    """Standard error; null where it is not known."""
    dgp: float | None
    """Daylight glare probability, Wienold and Christoffersen 2006; null in the dark."""
    dgp_error: float | None
    """Standard error; null where it is not known."""
    vertical_illuminance: float
    """At the eye, lx."""
    vertical_illuminance_error: float | None
    """Standard error; null where it is not known."""
    background_luminance: float
    """Of UGR, cd/m2."""
    sources: list[GlareSource]
    """Of UGR; those that count most first."""
    dgp_sources: list[GlareSource]
    """Of DGP; those that count most first."""
    notes: list[str]
    """Values outside of the range for which a formula was made, and other reasons that make a rating
    uncertain.
    """


@dataclass(frozen=True)
class Group:
    """All renders of a group together."""

    name: str
    renders: int
    """How many there are."""
    ended: int
    """Of these, those in a final state."""
    failed: int
    """Of those that ended: failed, cancelled or degraded."""
    fraction: float
    """Of the work of all: sample ranges merged, where a render that has ended counts as whole."""
    cpu_seconds: float
    """Processor seconds of workers so far."""
    predicted_end: float
    """Unix time at which the last of those that run should end; 0: unknown."""


@dataclass(frozen=True)
class Session:
    """Who the caller is."""

    name: str
    """Of the token; empty without authentication."""
    scopes: list[str]
    """Of read, submit, worker and admin."""


@dataclass(frozen=True)
class MeasuredRegions:
    """Parts of the film that are kept with the render."""

    regions: list[Outline]


@dataclass(frozen=True)
class Worker:
    """One worker process, as it last reported itself."""

    id: str
    engine: int
    """Version of the tracing engine; renders take results of one only."""
    threads: int
    rays_per_second: float
    """Over the last seconds, all threads together."""
    jobs_done: int
    started: float
    """Unix time, seconds."""
    quarantine: str
    """Why its results are refused; empty: they are taken."""
    floating_point_profile: str
    """How it rounds; renders take results of one profile only."""
    incompatible: str
    """Why it gets no jobs though it is not in quarantine; empty: it gets them."""
    drain: str
    """"draining": it finishes the jobs in hand and gets no others; "drained": it has none any more, and
    can be stopped; empty: neither.
    """
    unaudited: str
    """Why none of its results is audited, a sentence; empty: another machine is there."""


@dataclass(frozen=True)
class WorkOfWorker:
    """A render that a worker is tracing."""

    worker: str
    """Its id."""
    render: str
    """Id of the render."""
    name: str
    """Of the render."""
    tiles: int
    """How many of its tiles the worker has."""
    since: float
    """Unix time at which it was first seen with the oldest of these."""


@dataclass(frozen=True)
class OwnerUsage:
    """One owner's renders, those that were deleted included."""

    owner: str
    """Name of the token; empty without authentication."""
    weight: int
    """Of the token, among others: 200 gets twice the work of 100."""
    renders: int
    """All that there ever were."""
    open_renders: int
    """Queued, running or paused."""
    share: float
    """Part of the jobs in the hands of workers, now: 0 to 1."""
    cpu_seconds: float
    """Processor seconds of workers, in results that counted."""
    cost: float
    """Of these; 0 where no price is set."""
    stored_bytes: int
    """What its renders that are there take of the disk, at most."""


@dataclass(frozen=True)
class Usage:
    """Who uses what, of those that the caller may see."""

    core_hour_price: float
    """Of an hour of one processor; 0: none is set."""
    currency: str
    """Of the price."""
    owners: list[OwnerUsage]
    """Most processor time first."""


@dataclass(frozen=True)
class Webhook:
    """An address that gets a message when a render of its owner ends."""

    id: str
    owner: str
    """Name of the token that made it; empty without authentication."""
    url: str
    created: float
    """Unix time, seconds."""
    last_outcome: str
    """How the last message went, in words; empty before the first."""


@dataclass(frozen=True)
class NewWebhook:
    """A webhook with its secret, which no other answer has."""

    id: str
    owner: str
    """Name of the token that made it; empty without authentication."""
    url: str
    created: float
    """Unix time, seconds."""
    last_outcome: str
    """How the last message went, in words; empty before the first."""
    secret: str
    """What messages are signed with, by standardwebhooks.com."""


@dataclass(frozen=True)
class Pilot:
    """The small renders that the report goes by."""

    film: list[int]
    """Width and height, pixels."""
    samples: int
    """Per pixel of each render."""
    renders: int
    """Independent renders of each model."""
    cpu_seconds: float
    """What they took."""
    recommended_cpu_seconds: float | None
    """A budget that would show biases of half of the target; null: this one does."""
    effective_pixels: float
    """As in Progress."""
    heavy_tails: bool
    """Rare samples carry the noise: intervals and times are not to be trusted."""


@dataclass(frozen=True)
class Interval:
    """An estimate, and the interval that holds the truth with 95 %."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class PreflightModel:
    """The scene with some parts less. Errors are relative."""

    without: list[str]
    """Parts that are left out; empty: none."""
    verdict: str
    mean_bias: Interval
    """Of the mean luminance."""
    local_bias: Interval
    """Relative RMSE over pixels of the change."""
    noise_of_a_sample: float
    """Relative RMSE over pixels of one sample per pixel."""
    cost_ratio: Interval
    """Time of a sample, relative to the full model."""
    samples: int | None
    """Per pixel, to the target; null: out of reach."""
    cpu_seconds: float | None
    """Of one processor, to the target; null: out of reach."""


@dataclass(frozen=True)
class PreflightReport:
    """What a scene needs for an error."""

    error: float
    """The target."""
    film: list[int]
    """Width and height of the real render, pixels."""
    pilot: Pilot
    full: PreflightModel
    models: list[PreflightModel]
    """Each with one part less."""
    chosen: PreflightModel
    """The cheapest that stays within the target."""
    saving: float
    """How many times faster than the full model it gets there."""
    without_effect: list[str]
    """Parts that change nothing in the traced scene."""
    document: dict[str, Any]
    """The scene document of the chosen model."""


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a request."""

    place: str
    """Where: `$.scene.surfaces[3].kernel` in the body, `query.page_size`, ..."""
    message: str


@dataclass(frozen=True)
class ImportedScene:
    """A scene that was imported; its files are stored."""

    document: dict[str, Any]
    """The scene document."""
    scene: str
    """Path of the file that it was made of."""
    width: int
    """Of the file's film, pixels."""
    height: int
    """Of the file's film, pixels."""
    samples: int | None
    """Per pixel, as the file says; null: it does not."""
    notes: list[str]
    """Parts that are expressed differently."""
    missing: list[Problem]
    """Parts that were left out."""
