"""Pictures elsewhere: what tev and terminals receive, decoded by the published layouts."""

import base64
import re
import socket
import struct
import threading
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.preview.colour import linear_srgb, shown
from nocturne_client.preview.graphics import Graphics, graphics_of
from nocturne_client.preview.sinks import reduced
from nocturne_client.preview.terminal import picture, png
from nocturne_client.preview.tev import CHANNELS, Tev
from nocturne_client.tiles import Tile, decode_tiles


class TevFake:
    """Listens as tev does, and takes packets apart by the published layout."""

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self.received = bytearray()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        connection, _ = self._listener.accept()
        with connection:
            while piece := connection.recv(65536):
                self.received += piece

    def packets(self) -> list[dict[str, Any]]:
        """All of them, when the sender has gone."""
        self._thread.join(10)
        self._listener.close()
        found, at = [], 0
        while at < len(self.received):
            (length,) = struct.unpack_from("<I", self.received, at)
            found.append(_packet(bytes(self.received[at + 4 : at + length])))
            at += length
        assert at == len(self.received)
        return found


class _Reader:
    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def numbers(self, form: str) -> tuple[int, ...]:
        found = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return found

    def text(self) -> str:
        end = self.data.index(b"\0", self.at)
        found = self.data[self.at : end].decode()
        self.at = end + 1
        return found


def _packet(data: bytes) -> dict[str, Any]:
    read = _Reader(data)
    operation, grab_focus = read.numbers("BB")
    name = read.text()
    if operation == 4:
        width, height, count = read.numbers("3i")
        channels = [read.text() for _ in range(count)]
        assert read.at == len(data)
        return {"create": name, "front": grab_focus, "size": (width, height), "channels": channels}
    assert operation == 6
    (count,) = read.numbers("i")
    channels = [read.text() for _ in range(count)]
    x, y, width, height = read.numbers("4i")
    offsets, strides = read.numbers(f"{count}q"), read.numbers(f"{count}q")
    values = np.frombuffer(data, "<f4", offset=read.at)
    planes = {
        channel: values[offset::stride][: width * height].reshape(height, width)
        for channel, offset, stride in zip(channels, offsets, strides, strict=True)
    }
    return {"update": name, "front": grab_focus, "place": (x, y), "planes": planes}


def test_tev_gets_the_image_and_then_what_changed() -> None:
    fake = TevFake()
    pixels = np.random.default_rng(3).random((3, 5, 4)).astype(np.float32)
    with Tev(fake.address) as tev:
        tev.create("box r-1", 40, 30)
        tev.update([Tile(32, 0, 16, 0, pixels)])
    create, update = fake.packets()
    assert create == {"create": "box r-1", "front": 1, "size": (40, 30), "channels": [*CHANNELS]}
    assert (update["update"], update["front"], update["place"]) == ("box r-1", 0, (32, 0))
    for index, channel in enumerate(("X", "Y", "Z", "Y.stderr")):
        assert np.array_equal(update["planes"][channel], pixels[..., index])
    expected = linear_srgb(pixels[..., :3])
    assert np.array_equal(np.stack([update["planes"][c] for c in "RGB"], axis=-1), expected)


@pytest.mark.parametrize("address", ["127.0.0.1:1", "127.0.0.1:x", "127.0.0.1:99999"])
def test_no_tev_there(address: str) -> None:
    with pytest.raises(NocturneClientError, match="no tev listens"):
        Tev(address)


def test_a_port_beyond_the_last_is_no_other_port() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(NocturneClientError, match="expected at most 65535"):
            Tev(f"127.0.0.1:{taken.getsockname()[1] + 65536}")


@pytest.mark.parametrize(
    ("environment", "graphics"),
    [
        ({"TERM": "xterm-kitty", "KITTY_WINDOW_ID": "1"}, Graphics.KITTY),
        ({"TERM": "xterm-256color", "TERM_PROGRAM": "iTerm.app"}, Graphics.ITERM2),
        ({"TERM": "xterm-256color", "TERM_PROGRAM": "WezTerm"}, Graphics.ITERM2),
        ({"TERM": "foot"}, Graphics.SIXEL),
        ({"TERM": "mlterm-256color"}, Graphics.SIXEL),
        ({"TERM": "xterm-256color"}, None),
        ({"TERM": "screen-256color", "KITTY_WINDOW_ID": "1"}, None),
        ({}, None),
    ],
)
def test_which_terminals_show_images(environment: dict[str, str], graphics: Graphics | None) -> None:
    assert graphics_of(environment) is graphics


def _gradient(height: int = 31, width: int = 45) -> npt.NDArray[np.uint8]:
    y, x = np.mgrid[0:height, 0:width]
    return np.stack([255 * x // width, 255 * y // height, (3 * x + 5 * y) % 256], axis=-1).astype(np.uint8)


def test_png_is_read_back(tmp_path: Any) -> None:
    (tmp_path / "a.png").write_bytes(png(_gradient()))
    read = oiio.ImageBuf(str(tmp_path / "a.png")).get_pixels(oiio.UINT8)
    assert np.array_equal(np.asarray(read), _gradient())


def test_kitty_and_iterm_carry_the_png() -> None:
    noise = np.random.default_rng(1).integers(0, 256, (60, 60, 3), dtype=np.uint8)
    kitty = picture(noise, Graphics.KITTY).decode()
    pieces = re.findall(r"\x1b_G([^;]*);([^\x1b]*)\x1b\\", kitty)
    assert len(pieces) > 1
    assert all(len(content) <= 4096 for _, content in pieces)
    assert [keys.split(",")[-1] for keys, _ in pieces] == ["m=1"] * (len(pieces) - 1) + ["m=0"]
    assert base64.b64decode("".join(content for _, content in pieces)) == png(noise)
    iterm = picture(noise, Graphics.ITERM2)
    found = re.fullmatch(rb"\x1b\]1337;File=([^:]*):([^\x07]*)\x07\n", iterm)
    assert found is not None
    assert base64.b64decode(found[2]) == png(noise)
    assert f"size={len(png(noise))}".encode() in found[1]


def _unsixel(data: bytes) -> npt.NDArray[np.uint8]:
    """By the VT3xx manual: #N;2;R;G;B defines, #N chooses, !N repeats, $ goes back, - goes on."""
    found = re.fullmatch(r'\x1bPq"1;1;(\d+);(\d+)(.*)\x1b\\\n', data.decode(), re.DOTALL)
    assert found is not None
    width, height = int(found[1]), int(found[2])
    image = np.full((height + 6, width, 3), 7, dtype=np.uint8)
    colours: dict[int, tuple[int, ...]] = {}
    x = y = colour = 0
    pattern = r"#(\d+);2;(\d+);(\d+);(\d+)|#(\d+)|!(\d+)(.)|([$-])|([?-~])"
    for define, red, green, blue, choose, count, repeated, move, letter in re.findall(pattern, found[3]):
        if define:
            colours[int(define)] = tuple(round(int(part) * 2.55) for part in (red, green, blue))
        elif choose:
            colour = int(choose)
        elif move:
            x, y = 0, y + 6 * (move == "-")
        else:
            bits, run = ord(repeated or letter) - 63, int(count or 1)
            for row in range(6):
                if bits >> row & 1:
                    image[y + row, x : x + run] = colours[colour]
            x += run
    return image[:height]


def test_sixel_is_the_picture_in_216_colours() -> None:
    """A step is 51 of 255; a dither goes half a step further. On the mean nothing is off."""
    seen = _unsixel(picture(_gradient(), Graphics.SIXEL)).astype(int)
    difference = seen - _gradient()
    assert np.abs(difference).max() <= 51 + 1
    assert np.abs(difference.mean(axis=(0, 1))).max() < 4


def test_a_picture_is_exposed_by_itself_and_made_small() -> None:
    grey = np.full((700, 90, 3), 5000.0, dtype=np.float32) * np.array([0.95047, 1, 1.08883], np.float32)
    small = reduced(grey, 400)
    assert small.shape == (350, 45, 3)
    # 0.18 / 1.18 on the sRGB curve.
    assert np.abs(shown(small).astype(int) - 109).max() <= 1


def test_what_is_no_answer_with_tiles() -> None:
    for content in (b"", b"NXY1", b"{}" * 40, b"NXY1" + struct.pack("<7I", 4, 4, 4, 1, 0, 1, 0)):
        with pytest.raises(NocturneClientError, match="tiles can't be read"):
            decode_tiles(content)
