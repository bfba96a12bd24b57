"""A sky that both renderers show alike, and grey pictures for it and for textures."""

import math
from pathlib import Path

import numpy as np
import OpenImageIO

from bench.programs import Channel

SKY = "sky.exr"
_SKY_WIDTH, _SKY_HEIGHT = 1024, 512
# Luminances relative to the sky's at the zenith. The spot is many texels wide, so that both renderers, of
# which only one interpolates between texels, show the same sky.
_GROUND, _HORIZON, _SPOT = 0.1, 0.5, 2000.0
_SPOT_SIGMA_DEGREES = 1.5
_SPOT_DIRECTION = (-0.5, 0.65, -0.55)


def write_sky(path: Path) -> None:
    """A sky with a bright, blurred sun.

    Grey, so that its spectrum is D65 for both: each renderer upsamples coloured texels to spectra
    differently.
    """
    polar = (np.arange(_SKY_HEIGHT) + 0.5) * math.pi / _SKY_HEIGHT
    turn = (np.arange(_SKY_WIDTH) + 0.5) * 2 * math.pi / _SKY_WIDTH
    sine, up = np.sin(polar)[:, None], np.cos(polar)[:, None]
    # In the picture's middle, at half a turn, is +z; to the right of it is -x.
    towards = np.stack(np.broadcast_arrays(sine * np.sin(turn), up, -sine * np.cos(turn)), axis=-1)
    spot = np.array(_SPOT_DIRECTION) / np.linalg.norm(_SPOT_DIRECTION)
    angle = np.arccos(np.clip(towards @ spot, -1, 1))
    sky = _HORIZON + (1 - _HORIZON) * np.maximum(up, 0)
    # Smooth over some degrees about the horizon, for the same reason as the spot is wide.
    clear = 0.5 + 0.5 * np.tanh(up / 0.05)
    grey: Channel = _GROUND + (sky - _GROUND) * clear
    grey = grey + _SPOT * np.exp(-0.5 * (angle / math.radians(_SPOT_SIGMA_DEGREES)) ** 2)
    write_grey(path, grey)


def write_grey(path: Path, grey: Channel) -> None:
    """Writes a picture with three equal channels."""
    image = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(grey.shape[1], grey.shape[0], 3, OpenImageIO.FLOAT))
    image.set_pixels(OpenImageIO.ROI(), np.repeat(grey[..., None], 3, axis=2).astype(np.float32))
    if not image.write(str(path)):
        raise OSError(f"{path}: {image.geterror()}")
