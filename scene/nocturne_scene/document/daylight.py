"""What of a year's daylight is measured, in the scene document."""

from typing import Annotated, Literal

from pydantic import Field

from nocturne_scene.document.fields import AssetReference, Switch, Vector
from nocturne_scene.document.node import Node

Patches = Literal[145, 577, 2305]


class WeatherFile(Node):
    """Irradiances of each hour of a year."""

    asset: AssetReference = Field(
        description="An EPW file of the place: a path relative to the document, or `sha256:` and its digest."
    )


class YearOfDaylight(Node):
    """Daylight coefficients of the meters, from which a year is measured: what each patch of the sky brings
    ([how to](../how-to/daylight.md#by-a-service)).

    The scene's own sky and its lamps are left out. The film is repeated below itself for each batch, with
    other random numbers. A year takes three renders of a group, one for each value of `of`.
    """

    of: Literal["sky", "sun_reflected", "sun_straight"] = Field(
        description="`sky`: of patches of an even sky. `sun_reflected`: of patches in which the Sun is at "
        "some hour, by way of surfaces. `sun_straight`: of the Sun's disc in each hour, straight or through "
        "windows; one sample of each meter and batch is taken, however many are asked for."
    )
    weather: WeatherFile
    patches: Patches = Field(default=577, description="Of the sky.")
    sun_patches: Patches = Field(default=2305, description="For sunlight by way of surfaces.")
    batches: Annotated[int, Field(strict=True, ge=32, le=256, multiple_of=8)] = Field(
        default=32, description="Independent ones, for the intervals: a multiple of 8."
    )
    north: Vector | None = Field(
        default=None, description="Direction of north. Default: that of the scene's sky, or -z."
    )
    blinds: Literal["open", "closed"] = Field(
        default="open",
        description="Whether this is the scene with its blinds closed. Both together are six renders.",
    )
    melanopic: Switch = Field(
        default=False,
        description="Measure melanopic equivalent daylight illuminance instead of illuminance, all daylight "
        "being D65.",
    )
