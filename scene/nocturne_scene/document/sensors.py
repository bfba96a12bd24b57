"""Sensors as written in a scene document: cameras and meters.

Long: all that a sensor may be, which readers look up in one place.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.daylight import YearOfDaylight
from nocturne_scene.document.fields import Degrees, Finite, Name, PositiveLength, Vector
from nocturne_scene.document.instruments import Instrument
from nocturne_scene.document.light_fields import check_axes
from nocturne_scene.document.node import ByType, Node, one_of_names, problem_at, quoted_list
from nocturne_scene.document.placement import Motion
from nocturne_scene.document.shapes import length, parallel
from nocturne_scene.document.spectra import SpectrumReference
from nocturne_scene.spectra import lines as line_spectra
from nocturne_scene.spectra.named_responses import RESPONSES
from nocturne_scene.spectra.wavelength_range import LONGEST, SHORTEST

Observer = Literal["CIE 1931 2 degree", "CIE 1964 10 degree"]
_Angle = Annotated[Finite, Field(gt=0, lt=180)]
_BandEdge = Annotated[int, Field(strict=True, ge=int(SHORTEST), le=int(LONGEST))]


ResponseName = Annotated[
    str, Field(strict=True, json_schema_extra={"enum": list(RESPONSES)}), one_of_names("response", RESPONSES)
]


class Bands(Node):
    """Equal bands of wavelengths, side by side: a channel each, the mean spectral radiance (irradiance,
    intensity) in it, per nanometre."""

    first: _BandEdge = Field(description="Where the first begins, nm.")
    last: _BandEdge = Field(description="Where the last ends, nm.")
    width: Annotated[int, Field(strict=True, ge=1)] = Field(description="Of each, nm.")

    @model_validator(mode="after")
    def _fill_the_interval(self) -> Self:
        if self.last <= self.first or (self.last - self.first) % self.width:
            raise problem_at(".width", "expected a whole number of bands between first and last")
        if self.count > bounds.RESPONSES:
            raise problem_at(".width", f"{self.count} bands; at most {bounds.RESPONSES}")
        return self

    @property
    def count(self) -> int:
        return (self.last - self.first) // self.width

    @property
    def edges(self) -> list[tuple[int, int]]:
        """Where each begins and ends, nm."""
        starts = range(self.first, self.last, self.width)
        return [(start, start + self.width) for start in starts]


class _AnySensor(Node):
    observer: Observer = Field(
        default="CIE 1931 2 degree", description="Whose colour matching functions X, Y and Z are."
    )
    responses: Annotated[dict[Name, SpectrumReference], Field(max_length=bounds.RESPONSES)] = Field(
        default={},
        description="Further channels by name: response per unit of spectral radiance and nanometre, "
        "zero beyond a table. They are resolved to 1 nm: what is narrower or steeper keeps its integral and "
        "its centre, and becomes as wide.",
    )
    measures: ResponseName | None = Field(
        default=None,
        description="What takes the place of X, Y and Z, all three the same: light weighed by a response of "
        "this name, such as irradiance in W m⁻² (`radiant`), PPFD in µmol m⁻² s⁻¹ (`PAR`) or `erythemal` "
        "irradiance. Errors, regions and stops are then of that. Default: X, Y and Z of the observer, for "
        "which the scene's wavelengths must hold 360 to 830 nm.",
    )
    named_responses: Annotated[list[ResponseName], Field(max_length=len(RESPONSES))] = Field(
        default=[],
        description="Further channels by the names of published responses ([all](../how-to/wavelengths.md)).",
    )
    bands: Bands | None = Field(
        default=None,
        description="Spectral image: further channels named as spectral EXR files have it, such as "
        "`S0.555,000000nm` for the band around 555 nm.",
    )
    colour: bool = Field(
        default=False,
        description="Further channels `colour.00` and so on, 43 smooth responses from 380 to 780 nm. From "
        "these `nocturne measure --colour` tells the colour of the light that arrives: correlated colour "
        "temperature, Ra, Rf, Rg and the alpha-opic quantities of CIE S 026, each with its standard error.",
    )
    light_parts: bool = Field(
        default=False,
        description="Further channels `direct.X`, `direct.Y`, `direct.Z`, and `indirect.X` and so on: what "
        "luminaires send to the sensor straight or by one interaction, as with a `maximum_depth` of 1, and "
        "all other light. Together they are X, Y and Z.",
    )
    wavelengths: Literal["response", "uniform"] = Field(
        default="response",
        description="How a photon's wavelength is drawn: in proportion to X + Y + Z of the "
        "observer (a further response counts as much as these), or uniformly over the scene's wavelengths. "
        "Both give the same image; `response` with less noise. Where something emits lines narrower than "
        f"{line_spectra.NARROW:g} nm, half of the photons are drawn for lines: each emission spectrum "
        "that has such lines gets an equal part.",
    )
    motion: Motion | None = Field(
        default=None, description="Movement while the shutter is open; placements without `scale`."
    )

    @model_validator(mode="after")
    def _names_are_apart(self) -> Self:
        for index, name in enumerate(self.named_responses):
            if name in self.named_responses[:index]:
                raise problem_at(f".named_responses[{index}]", f'"{name}" is there twice')
        for name in self.responses:
            # A unit other than of power follows from the name.
            if name in self.named_responses or (name in RESPONSES and RESPONSES[name].amount != "W"):
                raise problem_at(
                    f".responses.{name}",
                    f'"{name}" is a published response; expected it in named_responses, or another name',
                )
        return self


class _Sensor(_AnySensor):
    stokes: bool = Field(
        default=False,
        description="How the light is polarised: further channels `S1.Y` and so on for S1, S2 and S3 of X, Y "
        "and Z and of each further channel, which is S0. They refer to the direction across that of view and "
        "across `up`, to the right ([signs](../explanation/polarisation.md)).",
    )
    position: Vector = Field(description="Where the sensor is, m.")
    look_at: Vector = Field(description="A point in the middle of the image.")
    up: Vector = Field(
        default=(0.0, 1.0, 0.0), description="A direction that is upwards in the image; not along the view."
    )

    @model_validator(mode="after")
    def _has_frame(self) -> Self:
        view = difference(self.look_at, self.position)
        if length(view) < bounds.MIN_LENGTH:
            raise problem_at(
                ".look_at", "look_at is the same point as position, so there is no direction of view"
            )
        if length(self.up) < bounds.MIN_LENGTH:
            raise problem_at(".up", "up has no length")
        if parallel(view, self.up):
            raise problem_at(".up", "up is parallel to the direction of view")
        return self


def difference(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


class _Perspective(_Sensor):
    vertical_field_of_view_degrees: _Angle = Field(
        description="Full angle between the image's top and bottom edges. The horizontal one "
        "follows from the image's shape."
    )


class Pinhole(_Perspective):
    """A camera whose opening is a point: everything is sharp."""

    type: Literal["pinhole"]


class Aperture(Node):
    """A lens opening with straight edges: a regular polygon with its corners on the lens's circle."""

    blades: Annotated[int, Field(strict=True, ge=3, le=bounds.APERTURE_BLADES)] = Field(
        description="Number of edges."
    )
    rotation_degrees: Degrees = Field(
        default=0.0, description="Of the first corner, from the image's right towards its top."
    )


class ThinLens(_Perspective):
    """A camera with an ideal lens: sharp at one distance only."""

    type: Literal["thin_lens"]
    lens_radius: PositiveLength = Field(description="Radius of the lens, m.")
    focus_distance: PositiveLength = Field(
        description="Distance of the sharp plane, m, along the direction of view."
    )
    aperture: Aperture | None = Field(default=None, description="Shape of the opening. Default: round.")


class Orthographic(_Sensor):
    """A camera that sees everything from the same direction: parallel lines stay parallel."""

    type: Literal["orthographic"]
    height: PositiveLength = Field(
        description="Height of the visible area, m; the width follows from the image's shape."
    )


class Panorama(_Sensor):
    """All directions in one image.

    Columns are equal steps of azimuth with `look_at` in the middle, rows equal steps of the angle from `up`
    down. `look_at` gives the azimuth only.
    """

    type: Literal["panorama"]


class IrradianceMeter(_AnySensor):
    """A flat film that light falls on. A pixel is the irradiance on it: Y is the illuminance in lx."""

    type: Literal["irradiance_meter"]
    position: Vector = Field(description="The film's centre, m.")
    normal: Vector | None = Field(default=None, description="Direction that the film faces.")
    look_at: Vector | None = Field(
        default=None, description="A point that the film faces, instead of `normal`."
    )
    up: Vector | None = Field(
        default=None,
        description="Upwards in the image. Default: y, or z where the film faces along y.",
    )
    height: PositiveLength = Field(
        description="Height of the film, m; its width follows from the image's shape."
    )

    @model_validator(mode="after")
    def _has_frame(self) -> Self:
        if (self.normal is None) == (self.look_at is None):
            raise problem_at(".normal", "expected either normal or look_at")
        if length(self.facing()) < bounds.MIN_LENGTH:
            place = ".normal" if self.look_at is None else ".look_at"
            raise problem_at(place, "gives no direction")
        if self.up is not None:
            if length(self.up) < bounds.MIN_LENGTH:
                raise problem_at(".up", "up has no length")
            if parallel(self.facing(), self.up):
                raise problem_at(".up", "up is parallel to the normal")
        return self

    def facing(self) -> tuple[float, float, float]:
        """The normal, of any length."""
        if self.look_at is not None:
            return difference(self.look_at, self.position)
        return self.normal or (0.0, 0.0, 0.0)

    def upwards(self) -> tuple[float, float, float]:
        """`up` or its default."""
        if self.up is not None:
            return self.up
        return (0.0, 0.0, 1.0) if parallel(self.facing(), (0.0, 1.0, 0.0)) else (0.0, 1.0, 0.0)


class RadianceMeter(_Sensor):
    """The mean radiance over a small disc and a narrow cone: Y is the luminance in cd/m².

    All pixels measure the same.
    """

    type: Literal["radiance_meter"]
    diameter: PositiveLength = Field(description="Of the disc around `position` from which it looks, m.")
    cone_degrees: _Angle = Field(description="Full angle of the cone around the direction of view.")


class IntensityMeter(_AnySensor):
    """The luminous intensity of a lamp in all directions, far away from it: Y is in cd.

    Columns are equal steps of the horizontal angle from 0 to 360 degrees, rows equal steps of the vertical
    angle from `axis` (0) to its opposite (180). The lamp is all that is inside a sphere; a body outside
    counts where it is seen through the sphere, with a warning. `nocturne ies` writes the image as a
    photometric file, which a luminaire's profile can be.
    """

    type: Literal["intensity_meter"]
    position: Vector = Field(description="Centre of the sphere that holds the lamp, m.")
    lamp_radius: PositiveLength = Field(description="Radius of that sphere, m.")
    axis: Vector = Field(default=(0.0, -1.0, 0.0), description="Direction of vertical angle 0.")
    zero: Vector = Field(
        default=(1.0, 0.0, 0.0),
        description="Direction of horizontal angle 0; what of it is along the axis is left out. Angles "
        "increase counter-clockwise for someone who looks along `axis`.",
    )

    @model_validator(mode="after")
    def _has_frame(self) -> Self:
        check_axes(self.axis, self.zero, ".axis", ".zero")
        return self


class Meters(_AnySensor):
    """Illuminance meters at points, on grids and on faces of surfaces, several in one render. A pixel is one
    of them: Y is the illuminance in lx.

    The film's size follows from the instruments: grids lie below one another, each as its plan, points and
    faces side by side. Pixels to their right measure what the last meter left of them does. Photons from
    luminaires do not meet points, so light that glass or mirrors gather is found from the meters alone; and
    meters share nothing, whatever `sharing` says.
    """

    type: Literal["meters"]
    instruments: Annotated[list[Instrument], Field(min_length=1, max_length=bounds.INSTRUMENTS)] = Field(
        description="What is measured where."
    )
    outdoor: Name | None = Field(
        default=None,
        description="The instrument whose mean is the illuminance outdoors: of all others `nocturne measure` "
        "tells the daylight factor.",
    )
    daylight: YearOfDaylight | None = Field(
        default=None, description="Measure daylight coefficients, for a year of daylight."
    )

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        names = [each.name for each in self.instruments]
        for index, name in enumerate(names):
            if name in names[:index]:
                raise problem_at(f".instruments[{index}].name", "another instrument has this name")
        if self.outdoor is not None and self.outdoor not in names:
            raise problem_at(".outdoor", f"no instrument has this name; expected one of {quoted_list(names)}")
        points = sum(columns * rows for columns, rows in (each.size for each in self.instruments))
        if points > bounds.METERS:
            raise problem_at(".instruments", f"have {points} points; at most {bounds.METERS}")
        for index, each in enumerate(self.instruments):
            if self.daylight is not None and each.faces is not None:
                raise problem_at(f".instruments[{index}].faces", "daylight of a year is of points and grids")
        return self

    @property
    def position(self) -> Vector:
        """The middle of all instruments, m."""
        middles = [each.middle() for each in self.instruments]
        x, y, z = (0.5 * (min(axis) + max(axis)) for axis in zip(*middles, strict=True))
        return (x, y, z)

    def layout(self) -> tuple[tuple[int, int], list[tuple[int, int]]]:
        """Width and height of the film, and the upper left pixel of each instrument."""
        width = max(each.size[0] for each in self.instruments)
        places, across, top = list[tuple[int, int]](), 0, 0
        for each in self.instruments:
            columns, rows = each.size
            if each.grid is not None or across + columns > width:
                top, across = top + (1 if across else 0), 0
            places.append((across, top))
            if each.grid is not None:
                top += rows
            else:
                across += columns
        return (width, top + (1 if across else 0)), places


CAMERAS = (Pinhole, ThinLens, Orthographic, Panorama)
Sensor = (
    Pinhole | ThinLens | Orthographic | Panorama | IrradianceMeter | RadianceMeter | IntensityMeter | Meters
)
SensorDefinition = Annotated[Sensor, ByType()]


def film_size(sensor: Sensor, width: int, height: int) -> tuple[int, int]:
    """Of a film that was asked for: with meters it follows from these."""
    if not isinstance(sensor, Meters):
        return width, height
    columns, rows = sensor.layout()[0]
    return columns, rows * (1 if sensor.daylight is None else sensor.daylight.batches)
