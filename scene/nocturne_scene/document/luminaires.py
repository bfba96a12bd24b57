"""Light as written in a scene document: luminaires on surfaces, the environment, discs at infinity."""

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import AssetReference, Degrees, Finite, NotNegative, Switch, Vector
from nocturne_scene.document.light_fields import HiddenFrom, LightGroup, check_axes
from nocturne_scene.document.node import ByKey, Node, problem_at
from nocturne_scene.document.placement import Placement
from nocturne_scene.document.shapes import ShapeDefinition, length, refuse_without_size
from nocturne_scene.document.skies import StandardSky, WeatherSky
from nocturne_scene.document.spectra import SpectrumReference
from nocturne_scene.document.textures import ColourReference, ColourTexture


class CosineProfile(Node):
    """Radiance falls with a power of the cosine of the angle to the normal: 0 is an ideal diffuse lamp."""

    cosine_power: Annotated[NotNegative, Field(le=bounds.PHONG_EXPONENT)] = Field(description="The power.")


class PhotometricProfile(Node):
    """The intensity that a photometric file gives, spread over the surface: IES LM-63 (types A, B and C),
    EULUMDAT, ANSI/IES TM-33, UNI 11733 or ATLA S001.

    Of the luminaire's `radiance` only the spectrum's shape counts then: the candelas are the file's. The
    surface's shape is a quad, a disc, a flat mesh or a sphere. What the file says of the directions behind a
    flat one is lost without `two_sided`, and a warning says how much that is. In a group, each instance shows
    a separate lamp with all of the file's light; it can't move.
    """

    asset: AssetReference = Field(
        description="The file: a path relative to the document, or `sha256:` and its digest."
    )
    lumens: Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)] | None = Field(
        default=None, description="Scale the intensities to this luminous flux, lm. Default: as in the file."
    )
    axis: Vector = Field(
        default=(0.0, -1.0, 0.0), description="Direction of vertical angle 0, before the surface's rotation."
    )
    zero: Vector = Field(
        default=(1.0, 0.0, 0.0),
        description="Direction of horizontal angle 0, plane C0; what of it is along the axis is left out. "
        "Angles increase counter-clockwise for someone who looks along `axis`, such as down on a lamp.",
    )

    @model_validator(mode="after")
    def _has_frame(self) -> Self:
        check_axes(self.axis, self.zero, ".axis", ".zero")
        return self


Profile = Annotated[
    CosineProfile | PhotometricProfile, ByKey({"cosine_power": CosineProfile, "asset": PhotometricProfile})
]


class Luminaire(Node):
    """What makes a surface emit light."""

    radiance: ColourReference | None = Field(
        default=None,
        description="Spectral radiance, W m⁻² sr⁻¹ nm⁻¹; with `lumens`, `watts` or `exitance` only the "
        "spectrum's shape counts. Default: the spectrum of the profile's file, if that has one.",
    )
    lumens: Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)] | None = Field(
        default=None,
        description="Luminous flux of the whole surface, of both sides if both emit, lm. In a group, of each "
        "place where an instance shows it, however large it is there.",
    )
    watts: Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)] | None = Field(
        default=None,
        description="The same as radiant flux over the scene's wavelengths, W: from 360 to 830 nm unless it "
        "says others.",
    )
    exitance: Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)] | None = Field(
        default=None, description="Luminous exitance of a side that emits, lm m⁻²."
    )
    two_sided: Switch = Field(
        default=False,
        description="Emit from both sides; otherwise only from the side that the normal points to.",
    )
    profile: Profile | None = Field(
        default=None,
        description="How the radiance depends on direction. Default: the same in all directions.",
    )
    hidden_from: HiddenFrom = None
    maintenance_factor: Annotated[Finite, Field(gt=0, le=1)] = Field(
        default=1.0,
        description="The part of the light that is left before the luminaire is cleaned and its lamps are "
        "replaced (CIE 97): scales all that it emits, however its amount is given.",
    )
    dimming: Annotated[Finite, Field(gt=0, le=1)] = Field(
        default=1.0, description="To which part of its full light the luminaire is dimmed."
    )
    light_group: LightGroup = ""

    @property
    def part_emitted(self) -> float:
        """Of the light that the document says."""
        return self.maintenance_factor * self.dimming

    @property
    def has_amount(self) -> bool:
        """Whether something else than its radiance says how much light there is."""
        return any(each is not None for each in (self.lumens, self.watts, self.exitance))

    @model_validator(mode="after")
    def _has_one_amount(self) -> Self:
        given = [name for name in ("lumens", "watts", "exitance") if getattr(self, name) is not None]
        if len(given) > 1:
            raise problem_at(
                f".{given[1]}", f"expected one of lumens, watts and exitance, found {' and '.join(given)}"
            )
        if self.radiance is None and not isinstance(self.profile, PhotometricProfile):
            raise problem_at(".radiance", "missing; only a photometric file may have a spectrum instead")
        if given and isinstance(self.profile, PhotometricProfile):
            raise problem_at(
                f".{given[0]}", "a photometric file says how much light there is; scale it by profile.lumens"
            )
        if given and isinstance(self.radiance, ColourTexture):
            raise problem_at(f".{given[0]}", "can't scale a radiance with a texture; scale its spectrum")
        return self

    @model_validator(mode="before")
    @classmethod
    def _has_size(cls, value: Any) -> Any:
        if isinstance(value, dict) and isinstance(value.get("type"), str):
            refuse_without_size(value["type"])
        return value


class ConstantEnvironment(Node):
    """The same radiance from all directions, infinitely far away."""

    radiance: SpectrumReference = Field(description="Spectral radiance, W m⁻² sr⁻¹ nm⁻¹.")
    hidden_from: HiddenFrom = None
    light_group: LightGroup = ""


class EnvironmentMap(Node):
    """Light from infinitely far away, from an image of all directions (latitude and longitude).

    The image's rows go from `up` to its opposite; its middle column is `forward`, and its right half
    is to the right of someone who looks along `forward` with `up` upwards. It is resampled to rows of
    equal steps of height (an equal-area cylindrical map).
    """

    asset: AssetReference = Field(
        description="A Radiance HDR or OpenEXR image, linear sRGB unless it says otherwise: a path relative "
        "to the document, or `sha256:` and its digest."
    )
    luminance: Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)] = Field(
        default=1.0,
        description="Luminance of a white texel of value 1, cd/m²; its spectrum is D65. Other colours get "
        "smooth spectra (Jakob and Hanika 2019).",
    )
    up: Vector = Field(default=(0.0, 1.0, 0.0), description="Direction of the image's top edge.")
    forward: Vector = Field(
        default=(0.0, 0.0, -1.0),
        description="Direction of the image's middle; what of it is along `up` is left out.",
    )
    pixels: Literal["areas", "points"] = Field(
        default="areas",
        description="`areas`: pixels are means over their areas. `points`: their values are interpolated in "
        "between, the first row being above and the last below, as in Mitsuba.",
    )
    rotate_degrees: Degrees = Field(
        default=0.0, description="Turn of the map about `up`, counter-clockwise seen from above."
    )
    hidden_from: HiddenFrom = None
    light_group: LightGroup = ""

    @model_validator(mode="after")
    def _has_frame(self) -> Self:
        check_axes(self.up, self.forward, ".up", ".forward")
        return self


EnvironmentDefinition = Annotated[
    ConstantEnvironment | EnvironmentMap | StandardSky | WeatherSky,
    ByKey(
        {
            "asset": EnvironmentMap,
            "radiance": ConstantEnvironment,
            "cie": StandardSky,
            "diffuse_horizontal": WeatherSky,
        }
    ),
]


class DistantDisc(Node):
    """A disc at infinity, such as the Sun. Give one of `radiance`, `irradiance` and `sun`."""

    direction: Vector = Field(description="Towards the disc, of any length but 0.")
    angular_diameter_degrees: Annotated[Finite, Field(le=180)] | None = Field(
        default=None, description="Its size in the sky, at least 0.01. Default: that of the Sun, 0.533."
    )
    radiance: SpectrumReference | None = Field(
        default=None, description="Spectral radiance at the disc's centre, W m⁻² sr⁻¹ nm⁻¹."
    )
    irradiance: SpectrumReference | None = Field(
        default=None,
        description="Spectral irradiance of a surface that faces the disc, W m⁻² nm⁻¹.",
    )
    sun: Switch = Field(
        default=False,
        description="The spectrum of the Sun above the atmosphere (ASTM G173-03), with its irradiance at "
        "the Earth's mean distance.",
    )
    limb_darkening: Switch = Field(
        default=False, description="Darker towards the edge, by wavelength, as the Sun is."
    )
    hidden_from: HiddenFrom = None
    light_group: LightGroup = ""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if length(self.direction) < bounds.MIN_LENGTH:
            raise problem_at(".direction", "direction has no length")
        size = self.angular_diameter_degrees
        if size is not None and size < bounds.MIN_ANGLE:
            raise problem_at(
                ".angular_diameter_degrees",
                f"a lamp needs a size; expected {bounds.MIN_ANGLE:g} to 180, found {size:g}",
            )
        given = [name for name in ("radiance", "irradiance") if getattr(self, name) is not None]
        given += ["sun"] if self.sun else []
        if len(given) != 1:
            found = " and ".join(given) if given else "none"
            raise problem_at("", f"expected one of radiance, irradiance and sun, found {found}")
        return self


class ImportantDirection(Placement):
    """A shape to aim photons at from anywhere in the scene, such as the opening of a reflector.

    It is no part of the scene: it only says where photons are sent more often.
    """

    shape: ShapeDefinition = Field(description="The shape; seen from both sides.")
    weight: Annotated[NotNegative, Field(le=1e6)] = Field(
        default=1.0, description="Relative to the other important directions."
    )
