"""Textures: the files that they are, how they are looked up, and pictures that are made of them."""

import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read.container import Container, unused_extensions, value
from nocturne_scene.formats.gltf.read.coordinates import Frame, relative_map
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.textures.image_files import MAX_EDGE, MAX_PIXELS
from nocturne_scene.textures.pictures import UnusableImageError, check_size, opened

Pixels = NDArray[np.float64]

_REPEAT, _CLAMP, _MIRROR = 10497, 33071, 33648
# Where the picture is another than the plain one, in a format that the core does not have.
_SOURCES = ("EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds")


@dataclass
class Pictures:
    """The textures of one file."""

    container: Container
    writer: SceneWriter
    findings: Findings
    _pixels: dict[int, Pixels] = field(default_factory=dict)

    def use(self, reference: Json, frame: Frame, place: str) -> Json:
        """The fields of a texture's use on a mesh with a frame's coordinates."""
        texture, _ = self._texture(reference, place)
        unused_extensions(reference, ("KHR_texture_transform",), self.findings, self.container.at(place))
        wrap, mirrored = self._wrap(texture, place)
        matrix = relative_map(self.container, reference, frame, place)
        if matrix is None:
            self.findings.lost(
                self.container.at(place),
                "no support for textures on one material with coordinates of several sets, or turned "
                "otherwise",
            )
            matrix = np.eye(3)
        matrix = np.diag([1 / (1 + each) for each in mirrored] + [1.0]) @ matrix
        use: Json = {"texture": {"wrap": wrap}}
        scale, offset = matrix.diagonal()[:2].tolist(), matrix[:2, 2].tolist()
        if scale != [1.0, 1.0] or offset != [0.0, 0.0]:
            use |= {"scale": scale, "offset": [offset[0], 1.0 - scale[1] - offset[1]]}
        return use

    def whole(self, use: Json, reference: Json, encoding: str, place: str) -> Json:
        """A use with the file of its texture as it came."""
        asset = self._asset(reference, place)
        return {**use, "texture": {**use["texture"], "asset": asset, "encoding": encoding}}

    def pixels(self, reference: Json, place: str) -> Pixels:
        """Pixels as stored, in [0, 1]: red, green, blue, and alpha where there is one.

        Mirrored ones with their mirror images.
        """
        texture, index = self._texture(reference, place)
        if index not in self._pixels:
            content, end = self.container.image(index, place)
            with tempfile.TemporaryDirectory() as folder:
                file = Path(folder) / f"image{end}"
                file.write_bytes(content)
                self._pixels[index] = self._decoded(file, place)
        found = self._pixels[index]
        _, (across, down) = self._wrap(texture, place)
        found = np.concatenate([found, found[:, ::-1]], axis=1) if across else found
        return np.concatenate([found, found[::-1]], axis=0) if down else found

    def baked(self, use: Json, pixels: Pixels, name: str) -> Json:
        """A texture of linear pixels in place of a use's own."""
        asset = self.writer.picture(name, pixels, narrow=True)
        return {**use, "texture": {**use["texture"], "asset": asset, "encoding": "linear"}}

    def _texture(self, reference: Json, place: str) -> tuple[Json, int]:
        """A texture and the number of its picture."""
        texture = self.container.item("textures", value(reference, "index", None), place)
        source = texture.get("source")
        for name in _SOURCES:
            source = value(value(value(texture, "extensions", {}), name, {}), "source", source)
        self.container.item("images", source, place)
        return texture, int(source or 0)

    def _asset(self, reference: Json, place: str) -> str:
        texture, source = self._texture(reference, place)
        if any(self._wrap(texture, place)[1]):
            pixels = self.pixels(reference, place)[..., :3]
            return self.writer.picture(f"image-{source}-mirrored", pixels, narrow=True)
        content, end = self.container.image(source, place)
        name = f"textures/image-{source}{end}"
        if not (self.writer.folder / name).exists():
            (self.writer.folder / "textures").mkdir(exist_ok=True)
            self.writer.file(name, content)
        return name

    def _wrap(self, texture: Json, place: str) -> tuple[str, tuple[bool, bool]]:
        """The mode beyond the edges, and whether that is a mirror image first, across and down."""
        sampler = self.container.item("samplers", texture["sampler"], place) if "sampler" in texture else {}
        modes = [sampler.get(f"wrap{axis}", _REPEAT) for axis in "ST"]
        if modes == [_CLAMP, _CLAMP]:
            return "clamp", (False, False)
        if not set(modes) <= {_REPEAT, _MIRROR}:
            self.findings.lost(
                self.container.at(place),
                "no support for a texture that is held at its edges in one direction only; repeated in both",
            )
        return "repeat", (modes[0] == _MIRROR, modes[1] == _MIRROR)

    def _decoded(self, file: Path, place: str) -> Pixels:
        try:
            with opened(file) as picture:
                check_size(picture.spec(), MAX_PIXELS, MAX_EDGE)
                read = picture.read_image(oiio.FLOAT)
        except UnusableImageError as error:
            raise InputError.at(self.container.at(place), str(error)) from None
        if read is None:
            raise InputError.at(self.container.at(place), "the image can't be read")
        pixels = np.atleast_3d(np.asarray(read, dtype=np.float64))
        # Of one or two channels the first is grey.
        return pixels[..., :4] if pixels.shape[2] >= 3 else pixels[..., [0, 0, 0, 1][: 2 + pixels.shape[2]]]
