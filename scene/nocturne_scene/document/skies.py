"""Skies as written in a scene document: by the CIE's formulas, and from measured irradiances; and where the
Sun is, by place and time.
"""

from datetime import datetime
from typing import Annotated, Self

import numpy as np
from pydantic import AfterValidator, Field, StringConstraints, model_validator

from nocturne_scene.daylight import solar_position
from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Finite, NotNegative, Vector
from nocturne_scene.document.light_fields import HiddenFrom, LightGroup, check_axes
from nocturne_scene.document.node import Node, problem_at
from nocturne_scene.document.shapes import length
from nocturne_scene.textures import standard_skies

_YEARS = (1900, 2100)


def _is_time(text: str) -> str:
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        raise problem_at("", f"{text!r} is no time; expected one such as 2026-03-21T09:00+01:00") from None
    if time.tzinfo is None:
        raise problem_at("", f"{text!r} has no zone; expected one at its end, such as +01:00, or Z")
    if not _YEARS[0] <= time.year < _YEARS[1]:
        raise problem_at("", f"expected a year from {_YEARS[0]} to {_YEARS[1] - 1}, found {time.year}")
    return text


Time = Annotated[str, StringConstraints(strict=True, max_length=40), AfterValidator(_is_time)]


class Place(Node):
    """Where on Earth a scene stands."""

    latitude: Annotated[Finite, Field(ge=-90, le=90)] = Field(
        description="Degrees to the north of the equator."
    )
    longitude: Annotated[Finite, Field(ge=-180, le=180)] = Field(
        description="Degrees to the east of Greenwich."
    )
    altitude: Annotated[Finite, Field(ge=-500, le=9000)] = Field(default=0.0, description="Above the sea, m.")
    north: Vector = Field(
        default=(0.0, 0.0, -1.0),
        description="Direction of north in the scene; what of it is along `up` is left out.",
    )


class _Sky(Node):
    """What skies have in common: where the Sun is, by `sun`, or by `place` and `time`."""

    sun: Vector | None = Field(default=None, description="Towards the Sun, above the horizon.")
    place: Place | None = Field(
        default=None, description="Instead of `sun`, with `time`: where on Earth the scene is."
    )
    time: Time | None = Field(
        default=None,
        description="When, as in ISO 8601 with a zone: 2026-03-21T09:00+01:00. The Sun's position is that of "
        "NREL's algorithm (Reda and Andreas 2004), refraction of a standard atmosphere included.",
    )
    up: Vector = Field(default=(0.0, 1.0, 0.0), description="Direction of the zenith.")
    hidden_from: HiddenFrom = None
    light_group: LightGroup = ""

    def towards_sun(self) -> tuple[float, float, float] | None:
        """Any length; None where nothing says where the Sun is."""
        found = self._sun()
        if found is None or self.place is None:
            return self.sun
        up = np.array(self.up) / length(self.up)
        north = np.array(self.place.north)
        north = north - (north @ up) * up
        north /= np.linalg.norm(north)
        x, y, z = found.towards()[0] @ np.stack([np.cross(north, up), north, up])
        return float(x), float(y), float(z)

    def sun_zenith(self) -> float:
        """Angle of the Sun from the zenith, degrees."""
        sun = self.towards_sun() or self.up
        cosine = sum(one * other for one, other in zip(sun, self.up, strict=True))
        return float(np.degrees(np.arccos(min(1.0, cosine / (length(sun) * length(self.up))))))

    def sun_distance(self) -> float:
        """Of the Sun, au; 1 where no time is known."""
        found = self._sun()
        return 1.0 if found is None else float(found.distance[0])

    def _sun(self) -> solar_position.Sun | None:
        if self.place is None or self.time is None:
            return None
        where = solar_position.Place(self.place.latitude, self.place.longitude, self.place.altitude)
        day = solar_position.julian_day(datetime.fromisoformat(self.time))
        return solar_position.sun_at(np.array([day]), where)

    def check_sun(self) -> None:
        """Whether the Sun is given once, and is up."""
        if length(self.up) < bounds.MIN_LENGTH:
            raise problem_at(".up", "up has no length")
        if self.sun is not None and (self.place is not None or self.time is not None):
            raise problem_at(".sun", "expected sun, or place and time")
        if (self.place is None) != (self.time is None):
            given, other = ("time", "place") if self.place is None else ("place", "time")
            raise problem_at(f".{given}", f"{given} alone says nothing of the Sun; add {other}")
        if self.place is not None:
            check_axes(self.up, self.place.north, ".up", ".place.north")
            if (zenith := self.sun_zenith()) >= 90:
                raise problem_at(
                    ".time", f"the Sun is {zenith - 90:.1f} degrees below the horizon; these skies are by day"
                )
        elif self.sun is not None:
            if length(self.sun) < bounds.MIN_LENGTH:
                raise problem_at(".sun", "sun has no length")
            if sum(one * other for one, other in zip(self.sun, self.up, strict=True)) <= 0:
                raise problem_at(".sun", "is below the horizon; these skies are those of the day")


class StandardSky(_Sky):
    """A CIE standard general sky (CIE S 011:2003), in the light of D65, over a dark ground.

    1 is the overcast sky with a steep gradation, 5 a sky of uniform luminance, 12 the clear sky of low
    turbidity; 16 is the older overcast sky. Give one of `zenith_luminance` and `illuminance`. Types 1, 3, 5
    and 16 are the same wherever the Sun is.
    """

    cie: Annotated[int, Field(strict=True, ge=1, le=standard_skies.OVERCAST)] = Field(
        description="Type of the sky, 1 to 16."
    )
    zenith_luminance: Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)] | None = Field(
        default=None, description="Luminance of the zenith, cd/m²."
    )
    illuminance: Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)] | None = Field(
        default=None, description="Illuminance of level ground by the whole sky without the Sun, lx."
    )
    sun_illuminance: Annotated[NotNegative, Field(le=bounds.LUMINANCE)] = Field(
        default=0.0,
        description="Illuminance across the Sun's beam, lx: adds the Sun's disc. Default: no disc.",
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.zenith_luminance is None) == (self.illuminance is None):
            raise problem_at("", "expected one of zenith_luminance and illuminance")
        self.check_sun()
        if self.sun is None and self.place is None:
            if standard_skies.needs_sun(self.cie):
                raise problem_at(".sun", f"missing; sky {self.cie} is brighter near the Sun")
            if self.sun_illuminance > 0:
                raise problem_at(".sun", "missing; the Sun's disc has to be somewhere")
        return self


class WeatherSky(_Sky):
    """Sky and Sun from two measured irradiances, as weather files have them, over a dark ground.

    The sky is that of Perez, Seals and Michalsky (1993), in the light of D65; the disc has sunlight's
    spectrum after 1.5 air masses (ASTM G173-03). Lumens follow from watts by the luminous efficacies of Perez
    et al. (1990). Where the fit has no light in any direction, the sky is even.
    """

    diffuse_horizontal: Annotated[Finite, Field(gt=0, le=1500)] = Field(
        description="Irradiance of level ground by the sky without the Sun, W/m²."
    )
    direct_normal: Annotated[NotNegative, Field(le=1500)] = Field(
        description="Irradiance across the Sun's beam, W/m²."
    )
    dew_point: Annotated[Finite, Field(ge=-80, le=40)] = Field(
        default=11.0, description="Dew point at the ground, °C: how much water is in the air."
    )
    without_sun: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="The sky alone, without the Sun's disc."
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        self.check_sun()
        if self.sun is None and self.place is None:
            raise problem_at(".sun", "missing; expected sun, or place and time")
        return self
