"""Picture files, opened as rows of red, green and blue, or grey, from the top, however they are stored.

Radiance pictures (G. Ward, "The RADIANCE Picture File Format"): rows or columns in any of eight orders,
numbers multiplied by EXPOSURE and COLORCORR, other PRIMARIES, XYZ. OpenEXR files: a data window other than
the display window, channels by name, other chromaticities. Other formats are as they are: what JPEG files say
of how a camera was held is not looked at, as other renderers do not.
"""

import math
import re
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene.library_words import said_by
from nocturne_scene.picture_windows import in_window, windows_of
from nocturne_scene.spectra.rgb import xyz_to_rgb

Pixels = NDArray[np.float32]

# As many as a texture may have, of which there are the largest.
_MAX_PIXELS = 2**26
_MAX_EDGE = 16384

_EXR = b"\x76\x2f\x31\x01"
_HEADER_BYTES = 64 * 2**10
# An empty line, then how many lines of pixels of what length there are.
_RESOLUTION = re.compile(rb"\n\r?\n([-+])([XY])[ \t]+(\d{1,9})[ \t]+([-+])([XY])[ \t]+(\d{1,9})[ \t\r]*\n")

# x and y of red, green, blue and white, IEC 61966-2-1.
_SRGB = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
# Files round theirs to hundredths.
_CLOSE = 0.006

# Cone responses to which whites are adapted: Bradford's, CIE 159:2004.
_BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


class UnusableImageError(Exception):
    """The file can't be used as a picture; the message says why."""


@contextmanager
def opened(source: Path) -> Iterator[Any]:
    """Open a picture as OpenImageIO's ImageInput; colours are not multiplied by opacity.

    Of a picture that is stored as it is shown only the header is read; else its pixels lie in a temporary
    file. Raises UnusableImageError.
    """
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    with tempfile.TemporaryDirectory() as folder:
        picture = oiio.ImageInput.open(str(_as_shown(source, Path(folder))), config)
        if picture is None:
            raise UnusableImageError(f"no picture that OpenImageIO can read: {said_by(oiio.geterror)}")
        try:
            yield picture
        finally:
            picture.close()


def check_size(spec: Any, pixels: int, edge: int) -> None:
    """Raise UnusableImageError where a header promises more than allowed."""
    if spec.depth > 1 or not (0 < spec.width <= edge and 0 < spec.height <= edge):
        raise UnusableImageError(
            f"{spec.width} x {spec.height} x {spec.depth} pixels; at most {edge} on an edge"
        )
    if spec.width * spec.height > pixels:
        raise UnusableImageError(f"{spec.width} x {spec.height} pixels; at most {pixels} are accepted")
    if not 1 <= spec.nchannels <= 64:
        raise UnusableImageError(f"{spec.nchannels} channels; expected 1 to 64")


def _as_shown(source: Path, folder: Path) -> Path:
    """A file of what a picture shows, in `folder`; the file itself where that is how it is stored."""
    try:
        with source.open("rb") as file:
            start = file.read(4)
    except OSError as error:
        raise UnusableImageError(f"the file can't be read: {error.strerror}") from None
    if start[:2] == b"#?":
        return _radiance(source, folder)
    return _exr(source, folder) if start == _EXR else source


@dataclass
class _Header:
    """Of a Radiance picture."""

    body: int
    """Where the pixels begin."""
    order: bytes
    """Sign and axis from one line of pixels to the next, and along one: -Y+X are rows from the top."""
    lines: int
    length: int
    factor: NDArray[np.float64]
    """What red, green and blue were multiplied with."""
    primaries: tuple[float, ...]
    is_xyz: bool

    @property
    def is_plain(self) -> bool:
        """Whether pixels are stored as they are seen."""
        is_plain = self.order == b"-Y+X" and not self.is_xyz
        return is_plain and bool(np.all(self.factor == 1.0)) and _are_srgb(self.primaries)


def _radiance_header(content: bytes) -> _Header | None:
    """None where there is none."""
    match = _RESOLUTION.search(content)
    if match is None or {match[2], match[5]} != {b"X", b"Y"}:
        return None
    factor, is_xyz = np.ones(3), False
    primaries: tuple[float, ...] = _SRGB
    for line in content[: match.start()].split(b"\n"):
        name, _, value = line.partition(b"=")
        numbers = _numbers(value)
        match name.strip().upper():
            # Both add up over the lines of a header.
            case b"EXPOSURE" if len(numbers) == 1 and numbers[0] > 0:
                factor *= numbers[0]
            case b"COLORCORR" if len(numbers) == 3 and min(numbers) > 0:
                factor *= numbers
            case b"PRIMARIES" if len(numbers) == 8 and _span_a_triangle(numbers):
                primaries = tuple(numbers)
            case b"FORMAT":
                is_xyz = value.strip().lower() == b"32-bit_rle_xyze"
    order = match[1] + match[2] + match[4] + match[5]
    return _Header(match.end(), order, int(match[3]), int(match[6]), factor, primaries, is_xyz)


def _numbers(text: bytes) -> list[float]:
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        return []
    return numbers if all(math.isfinite(number) for number in numbers) else []


def _radiance(source: Path, folder: Path) -> Path:
    with source.open("rb") as file:
        header = _radiance_header(file.read(_HEADER_BYTES))
        if header is None or header.is_plain:
            return source
        file.seek(header.body)
        plain = folder / "plain.hdr"
        size = f"-Y {header.lines} +X {header.length}\n"
        plain.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size.encode() + file.read())
    picture = oiio.ImageInput.open(str(plain))
    if picture is None:
        raise UnusableImageError(f"no picture that OpenImageIO can read: {said_by(oiio.geterror)}")
    pixels = _read(picture)
    picture.close()
    pixels = (pixels[..., :3] / header.factor).astype(np.float32)
    across, along = header.order[:2], header.order[2:]
    if across[1:] == b"X":
        pixels, across, along = pixels.swapaxes(0, 1), along, across
    # Rows are stored from the top with -Y, columns from the left with +X.
    pixels = pixels[:: 1 if across[:1] == b"-" else -1, :: 1 if along[:1] == b"+" else -1]
    matrix = _to_srgb(header.primaries, header.is_xyz)
    return _written(folder, pixels if matrix is None else pixels @ matrix.T, oiio.FLOAT)


def _exr(source: Path, folder: Path) -> Path:
    picture = oiio.ImageInput.open(str(source))
    if picture is None:
        # Asked, so that it is not said of another picture; told by who opens it.
        said_by(oiio.geterror)
        return source
    try:
        spec = picture.spec()
        chosen, is_xyz = _channels(list(spec.channelnames))
        primaries = tuple(float(each) for each in spec.getattribute("chromaticities") or _SRGB)
        matrix = _to_srgb(primaries, is_xyz) if len(chosen) >= 3 else None
        data, display = windows_of(spec)
        in_order = chosen == list(range(spec.nchannels))
        if data == display and in_order and matrix is None:
            return source
        pixels = _read(picture)[..., chosen]
        kind = spec.format.basetype
    finally:
        picture.close()
    if data != display:
        _check_window(*display[2:])
        pixels = in_window(pixels, data, display)
    if matrix is not None:
        pixels, kind = np.concatenate([pixels[..., :3] @ matrix.T, pixels[..., 3:]], axis=2), oiio.FLOAT
    return _written(folder, pixels, kind)


def _channels(names: list[str]) -> tuple[list[int], bool]:
    """Which channels are red, green, blue and alpha, or grey; and whether they are X, Y and Z instead.

    Raises UnusableImageError where several layers might be meant.
    """
    lower = [name.lower() for name in names]
    if len(names) < 3:
        return list(range(len(names))), False
    for parts in ("r g b a", "red green blue alpha", "x y z a"):
        if set(parts.split()[:3]) <= set(lower):
            return [lower.index(each) for each in parts.split() if each in lower], parts[0] == "x"
    layers = {name.rpartition(".")[0] for name in lower}
    layers = {each for each in layers if {f"{each}.{part}" for part in "rgb"} <= set(lower)}
    if len(layers) == 1:
        [layer] = layers
        return [lower.index(f"{layer}.{each}") for each in "rgba" if f"{layer}.{each}" in lower], False
    if layers:
        raise UnusableImageError(
            f"several layers, {', '.join(sorted(layers)[:8])}; expected R, G, B or one layer"
        )
    if "y" in lower and not {"ry", "by"} & set(lower):
        return [lower.index("y")], False
    raise UnusableImageError(f"channels {', '.join(names[:8])}; expected R, G, B, or X, Y, Z, or Y alone")


def _read(picture: Any) -> Pixels:
    """All pixels, shape (rows, columns, channels)."""
    spec = picture.spec()
    check_size(spec, _MAX_PIXELS, _MAX_EDGE)
    pixels = picture.read_image(0, 0, 0, spec.nchannels, oiio.FLOAT)
    if pixels is None:
        raise UnusableImageError(f"the picture can't be read: {said_by(picture.geterror)}")
    return np.asarray(pixels, dtype=np.float32).reshape(spec.height, spec.width, -1)


def _check_window(width: int, height: int) -> None:
    if not (0 < width <= _MAX_EDGE and 0 < height <= _MAX_EDGE and width * height <= _MAX_PIXELS):
        raise UnusableImageError(
            f"a display window of {width} x {height} pixels; at most {_MAX_EDGE} on an edge"
        )


def _written(folder: Path, pixels: NDArray[Any], kind: Any) -> Path:
    file = folder / "shown.exr"
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, kind)
    output = oiio.ImageOutput.create(str(file))
    if output is None or not output.open(str(file), spec):
        raise UnusableImageError(f"the picture can't be held: {said_by(oiio.geterror)}")
    output.write_image(np.ascontiguousarray(pixels, dtype=np.float32))
    output.close()
    return file


def _are_srgb(primaries: tuple[float, ...]) -> bool:
    return bool(np.all(np.abs(np.subtract(primaries, _SRGB)) < _CLOSE))


def _span_a_triangle(primaries: Sequence[float]) -> bool:
    """Whether primaries and white have colours at all: some programs write zeros."""
    x, y = np.array(primaries[0:6:2]), np.array(primaries[1:6:2])
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    return abs(area) > 1e-3 and primaries[7] > 0 and bool(np.all(np.isfinite(primaries)))


def _to_xyz(primaries: tuple[float, ...]) -> NDArray[np.float64]:
    """XYZ of linear red, green and blue, white of Y = 1."""
    x, y = np.array(primaries[0::2]), np.array(primaries[1::2])
    corners = np.stack([x[:3], y[:3], 1 - x[:3] - y[:3]])
    white = np.array([x[3], y[3], 1 - x[3] - y[3]]) / y[3]
    return np.asarray(corners * np.linalg.solve(corners, white))


def _to_srgb(primaries: tuple[float, ...], is_xyz: bool) -> Pixels | None:
    """The matrix to linear sRGB of XYZ, or of other primaries, whose white stays white; None for sRGB."""
    if is_xyz:
        return xyz_to_rgb().astype(np.float32)
    if len(primaries) != 8 or _are_srgb(primaries) or not _span_a_triangle(primaries):
        return None
    own, ours = _to_xyz(primaries), _to_xyz(_SRGB)
    before, after = (_BRADFORD @ matrix.sum(axis=1) for matrix in (own, ours))
    adapted = np.linalg.solve(_BRADFORD, (after / before)[:, None] * (_BRADFORD @ own))
    return np.linalg.solve(ours, adapted).astype(np.float32)
