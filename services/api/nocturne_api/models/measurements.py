"""Numbers of images: readings, measurements of parts, glare, isolines; and what guides their photons. Long: a
class for each."""

from typing import Annotated, Any, Literal, Self

from nocturne_scene.photometry import measuring, outlines
from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer, RequestBody
from nocturne_api.models.renders import Region

_POINTS = (
    "[x, y] in pixels from the film's upper left corner, where pixel i covers [i, i + 1). Two opposite "
    "corners of a rectangle; 3 to 256 corners of a polygon; of a line its first and last pixel, [0, 0] "
    "being the film's first one."
)
_ERROR = "Standard error; null where it is not known."

OutlineKind = Literal["rectangle", "polygon", "line"]


class OutlineRequest(RequestBody):
    """A part of the film to measure."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.OUTLINE]})

    name: str = Field(default="", max_length=100, description="At most 100 characters.")
    kind: OutlineKind
    points: list[list[float]] = Field(max_length=outlines.MAX_CORNERS, description=_POINTS)


class MeasureRequest(RequestBody):
    """What to measure; without outlines those kept with the render, and where there are none the whole
    film."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"outlines": [examples.OUTLINE], "bins": 64}]})

    outlines: list[OutlineRequest] = Field(default_factory=list, max_length=64)
    channel: str = Field(default="Y", description="X, Y, Z, or a further response of the sensor.")
    bins: int = Field(
        default=0, ge=0, le=measuring.MAX_BINS, description="Of a histogram of each outline; 0: none is made."
    )
    low: float = Field(
        default=0.0, description="Where the histogram begins; with high 0, too: by its values."
    )
    high: float = Field(default=0.0, description="Where the histogram ends.")
    logarithmic: bool = Field(default=False, description="Bins are even steps of the logarithm.")
    colour: bool = Field(
        default=False, description="Tell the colour of the light, where the sensor has `colour`."
    )


class KeepRegionsRequest(RequestBody):
    """Parts of the film that are kept with the render, instead of all that were."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"regions": [examples.OUTLINE]}]})

    regions: list[OutlineRequest] = Field(max_length=64)


class Outline(Answer):
    """A part of the film."""

    name: str
    kind: OutlineKind
    points: list[list[float]] = Field(description=_POINTS)

    @classmethod
    def of(cls, name: str, outline: outlines.Outline) -> Self:
        """The public side of an outline."""
        return cls(name=name, kind=outline.kind, points=[[x, y] for x, y in outline.points])


class MeasuredRegions(Answer):
    """Parts of the film that are kept with the render."""

    regions: list[Outline]


class PixelValue(Answer):
    """What one pixel shows."""

    x: int
    y: int
    value: float
    standard_error: float | None = Field(description=_ERROR)
    place: list[float] | None = Field(
        description="The middle of a meter's pixel, x, y, z in metres; null of other sensors."
    )


class ColourValue(Answer):
    """A number of the colour of the arriving light."""

    name: str = Field(description="Such as Ra, Rf, melanopic equivalent daylight illuminance.")
    value: float | None = Field(description="Null where the light has none.")
    standard_error: float | None = Field(description=_ERROR)
    unit: str = Field(description="In ASCII; empty: none.")


class DaylightFactor(Answer):
    """Illuminance over that outdoors, in percent (EN 17037)."""

    mean: float
    mean_error: float | None = Field(description=_ERROR)
    minimum: float
    minimum_error: float | None = Field(description=_ERROR)


class LinearPolarisation(Answer):
    """How the mean light is polarised."""

    degree: float = Field(
        description="Of linear polarisation, in [0, 1]: sqrt(S1^2 + S2^2) / S0 less the noise."
    )
    degree_interval: list[float] = Field(
        description="Low and high end of the 95 % interval; empty where errors are not known."
    )
    angle_degrees: float = Field(description="From the sensor's right towards up, in [0, 180).")
    angle_error: float | None = Field(
        description="Half of the 95 % interval, degrees; 90: nothing is known of it; null where errors are "
        "not known."
    )


class Histogram(Answer):
    """How many pixels have which values."""

    edges: list[float] = Field(description="Where bins begin and end: one more than there are counts.")
    counts: list[int]
    outside: int = Field(description="Pixels below the first bin or above the last.")
    logarithmic: bool


class Measurement(Answer):
    """One quantity over the pixels of an outline that have samples; the extremes are those of single
    pixels."""

    outline: Outline
    pixels: int
    zero_pixels: int = Field(description="In which no sample found light.")
    mean: float
    mean_error: float | None = Field(description=_ERROR)
    minimum: PixelValue
    maximum: PixelValue
    u0: float | None = Field(description="Uniformity, minimum over mean; null in the dark.")
    u0_error: float | None = Field(description=_ERROR)
    ud: float | None = Field(description="Minimum over maximum; null in the dark.")
    ud_error: float | None = Field(description=_ERROR)
    profile: list[PixelValue] = Field(description="Of a line: its pixels in order.")
    profile_csv: str = Field(description="The same as a table (RFC 4180); empty for other outlines.")
    histogram: Histogram | None = Field(description="Where one was asked for.")
    colour: list[ColourValue] = Field(description="Of the light, where it was asked for and is known.")
    daylight_factor: DaylightFactor | None = Field(
        description="Of meters whose sensor names an instrument outdoors."
    )
    linear_polarisation: LinearPolarisation | None = Field(
        description="Of the channel, where the sensor has `stokes` and there is light."
    )


class Measurements(Answer):
    """What outlines of an image show."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.MEASUREMENTS]})

    quantity: str = Field(description="The measured quantity; the channel's name where it is not Y.")
    unit: str
    channel: str
    measurements: list[Measurement] = Field(description="In the order of the outlines.")
    csv: str = Field(description="The same as a table (RFC 4180), without profiles and histograms.")


class Isoline(Answer):
    """Lines along which the image has one value."""

    level: float
    lines: list[list[list[float]]] = Field(
        description="Points [x, y] in pixels from the film's upper left corner; closed, or from border to "
        "border."
    )


class Isolines(Answer):
    """Lines along which the image has these values, of means over blocks of pixels."""

    quantity: str
    unit: str
    block: int = Field(description="Edge of a block in pixels.")
    isolines: list[Isoline] = Field(description="Lowest level first.")


class GlareSource(Answer):
    """Connected pixels that glare."""

    luminance: float = Field(description="Mean over its solid angle, cd/m2.")
    solid_angle: float = Field(description="sr.")
    position_index: float
    azimuth_degrees: float = Field(description="To the right of the line of sight.")
    elevation_degrees: float = Field(description="Above the line of sight.")


class Glare(Answer):
    """How much an eye is disturbed by what a panorama shows."""

    ugr: float | None = Field(
        description="Unified glare rating, CIE 117; null where it is not known: `notes` say why."
    )
    ugr_error: float | None = Field(description=_ERROR)
    dgp: float | None = Field(
        description="Daylight glare probability, Wienold and Christoffersen 2006; null in the dark."
    )
    dgp_error: float | None = Field(description=_ERROR)
    vertical_illuminance: float = Field(description="At the eye, lx.")
    vertical_illuminance_error: float | None = Field(description=_ERROR)
    background_luminance: float = Field(description="Of UGR, cd/m2.")
    sources: list[GlareSource] = Field(description="Of UGR; those that count most first.")
    dgp_sources: list[GlareSource] = Field(description="Of DGP; those that count most first.")
    notes: list[str] = Field(
        description="Values outside of the range for which a formula was made, and other reasons that make a "
        "rating uncertain."
    )


class ReadValue(Answer):
    """A mean and its error."""

    name: str = Field(description="X, Y, Z, or a further response of the sensor.")
    mean: float
    standard_error: float | None = Field(description="Of the mean; null where it is not known.")


class Reading(Answer):
    """Means over the pixels of a region that have samples."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.READING]})

    region: Region
    quantity: str = Field(description="What Y measures; empty where it is not known.")
    unit: str = Field(description="Of X, Y and Z.")
    response_unit: str = Field(description="Of a further response without its own unit.")
    values: list[ReadValue] = Field(description="X, Y, Z, then the sensor's further responses by name.")
    u_prime: float | None = Field(description="CIE 1976 u' of the mean; null in the dark.")
    v_prime: float | None = Field(description="CIE 1976 v' of the mean; null in the dark.")
    u_prime_error: float | None = Field(description="Standard error; null where it is not known.")
    v_prime_error: float | None = Field(description="Standard error; null where it is not known.")
    correlation: float = Field(
        description="How many times the variance of Y is that of pixels that know nothing of each other; at "
        "least 1."
    )
    coverage_factor: float | None = Field(
        description="Standard errors to each side of a 95 % interval: Student's t, 2.13 for a block with 16 "
        "samples, 1.96 where errors are well known; null where they are not known."
    )
    pixels: int
    zero_pixels: int = Field(description="In which no sample found light.")
    samples: int = Field(description="Of all pixels together.")
    fewest_samples: int = Field(description="Of any pixel.")
    most_samples: int = Field(description="Of any pixel.")
    invalid_samples: int = Field(description="Of the tiles that the region touches.")
    linear_polarisation: LinearPolarisation | None = Field(
        description="Of Y, where the sensor has `stokes` and there is light."
    )


_Vector = Annotated[list[float], Field(min_length=3, max_length=3)]


class Cone(Answer):
    """Directions to which photons are sent alike."""

    axis: _Vector = Field(description="Unit vector, from the place to where light came from.")
    half_angle_degrees: float


class LearnedLight(Answer):
    """Where light comes from that mirrors and glass gather, at what a pixel shows."""

    normal: _Vector | None = Field(
        description="Of the surface, on the side that is seen; null: the pixel shows none."
    )
    direction: _Vector | None = Field(description="Unit vector of the ray that meets it there.")
    interfaces: int = Field(description="Mirrors and clear boundaries by which it is seen; 0: directly.")
    cones: list[Cone] = Field(
        description="Half of the photons that are sent towards lights from here go into one of these, each "
        "as likely; empty: nothing was learned nearby."
    )

    @classmethod
    def of(cls, found: dict[str, Any]) -> Self:
        """What `nocturne-trace --learned-at` wrote."""
        cones = [Cone(axis=each[:3], half_angle_degrees=each[3]) for each in found["cones"]]
        return cls(
            normal=found["normal"], direction=found["direction"], interfaces=found["interfaces"], cones=cones
        )
