"""How tev shows the channels of every EXR that Nocturne writes: by the rules of its source.

github.com/Tom94/tev, `Channel::split` and `Image::getGroupedChannels`: the part of a channel's name before
its last dot is its layer; in a layer, channels of these names are one picture, every other is a separate
picture; and A is the layer's opacity.
"""

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_api.children import denoising as pictures
from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.output.images import Provenance, write_image
from nocturne_scene.bands import band_name
from nocturne_scene.layers import CHANNELS, Layers
from nocturne_scene.tile_sums import PRODUCTS, sums_per_pixel

_TOGETHER = ("RGB", "rgb", "C", "c", "M", "m", "XYZ", "xyz", "K", "k", "UV", "uv", "Z", "z")


def pictures_in_tev(channels: list[str]) -> dict[str, list[str]]:
    """By layer, as `(R,G,B)` or the one channel's name."""
    layers: dict[str, list[str]] = {}
    for channel in channels:
        layer, _, name = channel.rpartition(".")
        layers.setdefault(layer, []).append(name)
    found: dict[str, list[str]] = {}
    for layer, names in layers.items():
        found[layer] = []
        for together in _TOGETHER:
            group = [name for name in together if name in names]
            names = [name for name in names if name not in group]
            found[layer] += [f"({','.join(group)})" if len(group) > 1 else group[0]] if group else []
        found[layer] += names
    return found


def channels_of(path: Path) -> list[str]:
    return [*oiio.ImageBuf(str(path)).spec().channelnames]


def test_tev_shows_an_image_its_layers_parts_and_bands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bands = [band_name(middle) for middle in (450.0, 550.0)]
    parts = [f"{part}.{name}" for part in ("direct", "indirect") for name in "XYZ"]
    further = [*bands, *parts, "melanopic"]
    layers = Layers({name: np.ones((8, 8), np.float32) for each in CHANNELS.values() for name in each})
    squares = Squares(np.zeros((2, 2, PRODUCTS)), np.zeros((1, 1, PRODUCTS)), 8)
    sums = np.random.default_rng(1).random((8, 8, sums_per_pixel(len(further))))
    counts = np.full((8, 8), 4, np.uint32)
    image = tmp_path / "image.exr"
    write_image(image, sums, counts, squares, Provenance("00", "{}", 1), further, layers)
    shown = pictures_in_tev(channels_of(image))
    assert shown[""] == ["(R,G,B)", "(X,Y,Z)", "melanopic", "n"]
    assert {name: shown[name] for name in ("albedo", "N", "P", "depth", "direct", "indirect")} == {
        "albedo": ["(R,G,B)"],
        "N": ["(X,Y,Z)"],
        "P": ["(X,Y,Z)"],
        "depth": ["Z"],
        "direct": ["(X,Y,Z)"],
        "indirect": ["(X,Y,Z)"],
    }
    assert sorted(shown["id"]) == ["material", "object"]
    assert shown["S0"] == ["450,000000nm", "550,000000nm"]
    # Errors and their correlations are layers named by their channel; none has the name of an opacity.
    assert shown["Y"] == ["blockRatio", "ownRatio", "stderr", "tileRatio"]
    assert shown["S0.450,000000nm"] == ["stderr"]
    assert not any("A" in names for names in shown.values())
    # The test reads only the file, so any denoiser will do.
    monkeypatch.setattr(pictures, "denoised", lambda channels: np.dstack([channels[name] for name in "RGB"]))
    pictures.write_denoised(image, tmp_path)
    denoised = pictures_in_tev(channels_of(tmp_path / pictures.EXR))
    assert denoised == {"denoised": ["(R,G,B)"], "difference": ["errorBars"]}
