"""Textures as written in a scene document, and values that may vary over a surface by one."""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, ValidationInfo

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import AssetReference, Finite, Fraction, NotNegative, Switch
from nocturne_scene.document.node import ByKey, Node
from nocturne_scene.document.spectra import (
    SPECTRUM_KEYS,
    InlineSpectrum,
    SpectrumName,
    SpectrumReference,
    known_name,
)

_Repeat = Annotated[Finite, Field(ge=-bounds.TEXTURE_SCALE, le=bounds.TEXTURE_SCALE)]
_Gain = Annotated[Finite, Field(ge=-bounds.LENGTH, le=bounds.LENGTH)]
Encoding = Literal["sRGB", "linear"]


class Texture(Node):
    """An image that varies a value over a surface. Any format that OpenImageIO reads, such as PNG or EXR.

    u goes from the image's left edge (0) to its right (1), v from its bottom edge up to its top. What
    Radiance HDR and OpenEXR files say of themselves counts: order of lines, exposure, windows, channels (R,
    G, B; X, Y, Z; Y) and primaries.
    """

    asset: AssetReference = Field(
        description="The image file: a path relative to the document, or `sha256:` and its digest."
    )
    encoding: Encoding | None = Field(
        default=None,
        description="How stored numbers stand for light: by the sRGB curve, or in proportion. Default: "
        "`sRGB` for colours, unless the file holds floating-point numbers; `linear` for all else.",
    )
    wrap: Literal["repeat", "clamp"] = Field(
        default="repeat", description="Beyond the image's edges: repeat it, or hold the edge."
    )
    sharp: Switch = Field(
        default=False,
        description="Use the image as it is at every point, instead of its mean over what a photon covers: "
        "for edges that must not be blurred.",
    )


def _known_texture(name: str, info: ValidationInfo) -> str:
    return known_name(name, "texture", "textures", info)


def _texture_tag(value: Any) -> str | None:
    return "<name>" if isinstance(value, str) else "<texture>"


# A texture's name in $.textures, or a texture.
TextureReference = Annotated[
    Annotated[str, Field(strict=True, title="name"), AfterValidator(_known_texture), Tag("<name>")]
    | Annotated[Texture, Tag("<texture>")],
    Discriminator(_texture_tag),
]


class TextureUse(Node):
    """Fields of all that looks up a texture: at the surface's coordinates times `scale` plus `offset`."""

    texture: TextureReference = Field(description="A name from `$.textures`, or a texture.")
    scale: tuple[_Repeat, _Repeat] = Field(
        default=(1.0, 1.0), description="How often the image is repeated along u and v."
    )
    offset: tuple[_Repeat, _Repeat] = Field(default=(0.0, 0.0), description="Shift along u and v.")


class ScalarTexture(TextureUse):
    """A number that varies over a surface: the texture's value times `gain` plus `bias`, kept in [0, 1].

    Of a colour image it is the luminance.
    """

    gain: _Gain = Field(default=1.0, description="Factor.")
    bias: _Gain = Field(default=0.0, description="What is added.")


class ColourTexture(TextureUse):
    """A spectrum that varies over a surface: `spectrum` times what the texture holds.

    A colour image's texels (sRGB primaries) become the smooth spectra of Jakob and Hanika (2019); those of a
    grey image are plain factors.
    """

    spectrum: SpectrumReference = Field(
        default=1.0, description="What the texture is multiplied with: for a luminaire, its radiance."
    )
    grey: Switch = Field(default=False, description="Use the texture's luminance, as a factor.")


class NormalMap(TextureUse):
    """Shading normals: x, y, z stored as 0.5 + 0.5 n, x along u, y along v. Always linear and sharp."""


class BumpMap(TextureUse):
    """Shading normals from heights; of a colour image the luminance is taken. Always sharp."""

    height: Annotated[NotNegative, Field(le=bounds.LENGTH)] = Field(
        description="Height that the value 1 stands for, m; 0 is the surface itself."
    )


# A number in [0, 1] that may vary over a surface.
ScalarReference = Annotated[Fraction | ScalarTexture, ByKey({"texture": ScalarTexture})]

# A spectrum that may vary over a surface.
ColourReference = Annotated[
    SpectrumName | InlineSpectrum | ColourTexture, ByKey({**SPECTRUM_KEYS, "texture": ColourTexture})
]
