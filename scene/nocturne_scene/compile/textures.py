"""Textures, and values that may vary by one."""

import json
from collections.abc import Callable
from typing import Literal, NamedTuple

import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne.v1 import scene_pb2

from nocturne_scene.blobs import NoteKey
from nocturne_scene.compile import spectra
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.spectrum_checks import Reference
from nocturne_scene.document.textures import (
    BumpMap,
    ColourTexture,
    NormalMap,
    ScalarTexture,
    Texture,
    TextureUse,
)
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.textures import image_files as image_textures
from nocturne_scene.textures.pictures import UnusableImageError, opened

_CONVERSION = 5
"""Number of how pictures become texture files; raised with every change of that, since these are kept."""

_ENCODINGS: dict[str, image_textures.Encoding] = {"sRGB": "srgb", "linear": "linear"}


class _Facts(NamedTuple):
    """About a texture file."""

    channels: int
    least: float
    most: float


class Textures:
    """Compiles textures, each for each way of use once, and what may vary by them."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._converted: dict[tuple[str, int, str, str, bool], int] = {}
        self.uses = 0
        """How often a texture was asked for; tells whether something compiled in between varies."""
        self.rgb_table: scene_pb2.RgbTable | None = None
        """Needed by all textures in colour, once there is one."""

    def scalar(self, value: float | ScalarTexture, suffix: str = "") -> scene_pb2.Scalar:
        """Return a number that may vary; raises Unusable."""
        if not isinstance(value, ScalarTexture):
            return scene_pb2.Scalar(constant=value)
        use = self._use(value, 1, "linear", suffix)
        use.gain, use.bias = value.gain, value.bias
        return scene_pb2.Scalar(texture=use)

    def reflectance(self, value: Reference | ColourTexture, suffix: str = "") -> scene_pb2.Colour:
        """Return a reflectance that may vary; raises Unusable."""
        if not isinstance(value, ColourTexture):
            return scene_pb2.Colour(spectrum=self._workspace.reflectance(value))
        spectrum = self._workspace.reflectance(value.spectrum)
        return scene_pb2.Colour(spectrum=spectrum, texture=self._colour_use(value, suffix))

    def radiance(
        self,
        value: Reference | ColourTexture,
        suffix: str,
        *,
        amount: Callable[[scene_pb2.Spectrum], scene_pb2.Spectrum] | None = None,
        part: float = 1.0,
    ) -> scene_pb2.Colour | None:
        """Return a radiance that may vary, None if it is black; raises Unusable.

        `amount`: scales the spectrum to how much light there is; None: it says so itself.
        `part`: of all that, what is emitted.
        """
        texture = value if isinstance(value, ColourTexture) else None
        if texture is not None:
            suffix = f"{suffix}.spectrum"
        try:
            message = spectra.radiance(
                self._workspace.spectrum(value.spectrum if isinstance(value, ColourTexture) else value),
                self._workspace.spectral,
            )
            if self._workspace.is_dark(message):
                return None
            if amount is not None:
                message = amount(message)
                spectra.check_finite(message)
            if part != 1.0:
                message = spectra.scaled_evenly(message, part)
        except spectra.NotCompilableError as error:
            raise Unusable(str(error), suffix) from None
        colour = scene_pb2.Colour(spectrum=self._workspace.spectra.index_of(message))
        if texture is not None:
            colour.texture.CopyFrom(self._colour_use(texture, suffix.removesuffix(".spectrum")))
        return colour

    def normals(self, value: NormalMap) -> scene_pb2.TextureUse:
        """Return a map of normals; raises Unusable."""
        return self._use(value, 3, "linear", "")

    def heights(self, value: BumpMap) -> scene_pb2.TextureUse:
        """Return a map of heights in metres; raises Unusable."""
        use = self._use(value, 1, "linear", "")
        use.gain = value.height
        return use

    def _colour_use(self, value: ColourTexture, suffix: str) -> scene_pb2.TextureUse:
        use = self._use(value, 1 if value.grey else None, None, suffix)
        if self._workspace.textures.messages[use.texture].channels == 3 and self.rgb_table is None:
            blob = rgb_spectra.table_blob()
            self.rgb_table = scene_pb2.RgbTable(
                blob=self._workspace.keep(blob), resolution=rgb_spectra.resolution_of(blob)
            )
        return use

    def _use(
        self,
        value: TextureUse,
        channels: Literal[1, 3] | None,
        encoding: Literal["linear"] | None,
        suffix: str,
    ) -> scene_pb2.TextureUse:
        """`channels` and `encoding` None: as fits a colour in this file."""
        self.uses += 1
        texture = value.texture
        if isinstance(texture, str):
            self._workspace.use("textures", texture)
            place, texture = "", self._workspace.document.textures[texture]
        else:
            place = ".texture.asset"
        try:
            index = self._texture(texture, channels, encoding)
        except UnusableImageError as error:
            raise Unusable(str(error), suffix + (place or ".texture")) from None
        except Unusable as error:
            raise Unusable(str(error), suffix + (place or ".texture")) from None
        return scene_pb2.TextureUse(
            texture=index,
            scale_u=value.scale[0],
            scale_v=value.scale[1],
            offset_u=value.offset[0],
            offset_v=value.offset[1],
            gain=1.0,
        )

    def _texture(
        self, texture: Texture, channels: Literal[1, 3] | None, encoding: Literal["linear"] | None
    ) -> int:
        digest = self._workspace.asset(texture.asset)
        key = (texture.asset, channels or 0, texture.encoding or encoding or "", texture.wrap, texture.sharp)
        if key not in self._converted:
            blob, facts = self._convert(digest.hex(), channels, texture.encoding or encoding)
            message = scene_pb2.Texture(
                blob=blob,
                channels=facts.channels,
                clamp=texture.wrap == "clamp",
                sharp=texture.sharp,
            )
            if facts.channels == 1:
                message.least, message.most = facts.least, facts.most
            self._converted[key] = self._workspace.textures.index_of(message)
        return self._converted[key]

    def _convert(
        self, asset: str, channels: Literal[1, 3] | None, encoding: Literal["sRGB", "linear"] | None
    ) -> tuple[bytes, "_Facts"]:
        """Digest of a picture's texture file, made once for all scenes of a blob store, and its facts."""
        workspace = self._workspace
        about = NoteKey(asset, json.dumps(["texture", channels, encoding, _CONVERSION]))
        match workspace.made_before(about):
            case (bytes(before), [int(of_before), float(least), float(most)]):
                return before, _Facts(of_before, least, most)
        file = workspace.blobs.path(asset)
        with opened(file) as picture:
            spec = picture.spec()
            is_grey = spec.nchannels < 3
            is_linear = spec.format.basetype in (oiio.HALF, oiio.FLOAT)
        chosen: Literal[1, 3] = channels or (1 if is_grey else 3)
        encoded = encoding or ("linear" if is_linear else "sRGB")
        made = image_textures.convert(file, chosen, _ENCODINGS[encoded])
        blob, facts = workspace.keep(made.content), _Facts(chosen, made.least, made.most)
        workspace.note_made(about, blob, list(facts))
        return blob, facts
