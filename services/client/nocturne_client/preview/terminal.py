"""Images in terminals: the bytes of each method to show one.

kitty: sw.kovidgoyal.net/kitty/graphics-protocol. iTerm2: iterm2.com/documentation-images.html. Sixel: DEC's
VT3xx, vt100.net/docs/vt3xx-gp/chapter14.html.
"""

import base64
import struct
import zlib

import numpy as np
import numpy.typing as npt

from nocturne_client.preview.graphics import Graphics

Pixels = npt.NDArray[np.uint8]

_KITTY_PIECE = 4096
_SIXEL_ROWS = 6
# Six steps of each primary and an ordered dither: 216 of the 256 colours that sixel terminals have.
_STEPS = 6
_BAYER = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]]) / 16 - 15 / 32


def picture(pixels: Pixels, graphics: Graphics) -> bytes:
    """The image at the cursor; `pixels` of shape (height, width, 3)."""
    if graphics is Graphics.KITTY:
        return _kitty(pixels)
    if graphics is Graphics.ITERM2:
        content = png(pixels)
        name = f"inline=1;size={len(content)};width={pixels.shape[1]}px;preserveAspectRatio=1"
        return b"\x1b]1337;File=" + name.encode() + b":" + base64.b64encode(content) + b"\x07\n"
    return _sixel(pixels)


def _kitty(pixels: Pixels) -> bytes:
    """In pieces of 4096 characters; q=2: the terminal does not answer."""
    content = base64.b64encode(png(pixels))
    pieces = [content[start : start + _KITTY_PIECE] for start in range(0, len(content), _KITTY_PIECE)]
    written = []
    for index, piece in enumerate(pieces):
        more = int(index + 1 < len(pieces))
        keys = f"a=T,f=100,q=2,m={more}" if index == 0 else f"m={more}"
        written.append(b"\x1b_G" + keys.encode() + b";" + piece + b"\x1b\\")
    return b"".join(written) + b"\n"


def png(pixels: Pixels) -> bytes:
    """ISO/IEC 15948: RGB of 8 bits without filters."""
    height, width = pixels.shape[:2]
    rows = np.zeros((height, 1 + 3 * width), dtype=np.uint8)
    rows[:, 1:] = pixels.reshape(height, -1)
    header = struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 6)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks
    )


def _sixel(pixels: Pixels) -> bytes:
    """Bands of six rows; in each, one pass for every colour in it, with runs of equal columns shortened."""
    height, width = pixels.shape[:2]
    dither = np.tile(_BAYER, (-(-height // 4), -(-width // 4)))[:height, :width, None]
    steps = np.clip(np.rint(pixels / 255 * (_STEPS - 1) + dither), 0, _STEPS - 1).astype(int)
    colours = (steps[..., 0] * _STEPS + steps[..., 1]) * _STEPS + steps[..., 2]
    parts = [f'\x1bPq"1;1;{width};{height}']
    parts += [f"#{colour};2;{_percent(colour)}" for colour in np.unique(colours)]
    for top in range(0, height, _SIXEL_ROWS):
        band = colours[top : top + _SIXEL_ROWS]
        bits = (1 << np.arange(band.shape[0]))[:, None]
        lines = [f"#{colour}{_runs((bits * (band == colour)).sum(axis=0))}" for colour in np.unique(band)]
        parts.append("$".join(lines) + "-")
    return "".join([*parts, "\x1b\\\n"]).encode()


def _percent(colour: int) -> str:
    red, rest = divmod(int(colour), _STEPS * _STEPS)
    return ";".join(str(100 * part // (_STEPS - 1)) for part in (red, *divmod(rest, _STEPS)))


def _runs(columns: npt.NDArray[np.int_]) -> str:
    """Columns of six bits as letters from "?", `!COUNT` before one that comes often."""
    ends = np.flatnonzero(np.diff(columns)) + 1
    starts = [0, *ends.tolist()]
    lengths = np.diff([*starts, len(columns)])
    texts = []
    for start, length in zip(starts, lengths, strict=True):
        letter = chr(63 + int(columns[start]))
        texts.append(f"!{length}{letter}" if length > 3 else letter * int(length))
    return "".join(texts)
