"""Makes denoised pictures of an EXR of ours: Intel's Open Image Denoise, guided by albedo and normals.

A denoised picture is smooth where the true image has noise, and wrong by nobody knows how much. So its EXR
has no channel that any reader of ours takes for an image, and a map says where it leaves the true image.

As a program: the job on standard input, why it failed on standard output, both JSON.
"""

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenEXR
from nocturne_coordinator.output.images import FINAL_COMPRESSION, srgb_to_xyz, write_preview, write_rgb_png

Values = npt.NDArray[np.float32]

EXR, PNG, DIFFERENCE = "denoised.exr", "denoised.png", "difference.png"
LABEL = "To look at, not to measure: Open Image Denoise made it of nocturne:scene's noisy image"

# Error bars from which the map has a colour: the 68, 95 and 99.7 % intervals of a normal distribution.
_STEPS = ((0.0, (32, 32, 40)), (1.0, (70, 90, 140)), (2.0, (230, 190, 60)), (3.0, (214, 69, 65)))


def write_denoised(image: Path, folder: Path) -> None:
    """Writes EXR, PNG and DIFFERENCE into `folder`. Raises ImportError without pyoidn, RuntimeError and
    KeyError for a file that is none of ours."""
    with OpenEXR.File(str(image), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
        header = dict(file.header())
    rgb = denoised(channels)
    xyz = srgb_to_xyz(rgb)
    bars = error_bars(xyz[..., 1], channels["Y"], channels["Y.stderr"])
    # As bright as the true image: black pixels are no longer quite black, which would move the mean.
    once = np.ones(bars.shape, np.uint32)
    write_preview(folder / PNG, xyz.astype(np.float64), once, FINAL_COMPRESSION, channels["Y"])
    write_rgb_png(folder / DIFFERENCE, coloured(bars))
    planes = dict(zip(("denoised.R", "denoised.G", "denoised.B"), np.moveaxis(rgb, -1, 0), strict=True))
    planes["difference.errorBars"] = bars
    kept = {name: header[name] for name in ("nocturne:scene", "chromaticities") if name in header}
    said = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, "nocturne:denoised": LABEL}
    with OpenEXR.File(
        {**kept, **said}, {name: np.ascontiguousarray(planes[name]) for name in planes}
    ) as file:
        file.write(str(folder / EXR))


def denoised(channels: Mapping[str, Any]) -> Values:
    """Linear sRGB, shape (height, width, 3)."""
    # Of a hundred megabytes, and not everybody's: the extra `denoise` of this package.
    from pyoidn import denoise

    colour = np.maximum(_planes(channels, ("R", "G", "B")), 0.0)
    albedo, normal = ("albedo.R", "albedo.G", "albedo.B"), ("N.X", "N.Y", "N.Z")
    guides: dict[str, Values] = {}
    if channels.keys() >= {*albedo}:
        guides["albedo"] = np.clip(_planes(channels, albedo), 0.0, 1.0)
        # Normals guide only together with an albedo.
        if channels.keys() >= {*normal}:
            guides["normal"] = np.clip(_planes(channels, normal), -1.0, 1.0)
    found: Values = denoise(colour, **guides, hdr=True)
    return found


def error_bars(y: Values, true_y: Values, error: Values) -> Values:
    """How many standard errors a picture is from the true image; 0 where both are the same."""
    off = np.abs(y - true_y)
    bars: Values = np.divide(
        off, error, out=np.where(off > 0.0, np.inf, 0.0).astype(np.float32), where=error > 0
    )
    return bars


def coloured(bars: Values) -> npt.NDArray[np.uint8]:
    """The map: dark within the error bar, then blue, yellow and red."""
    picture = np.zeros((*bars.shape, 3), np.uint8)
    for least, colour in _STEPS:
        picture[bars >= least] = colour
    return picture


def _planes(channels: Mapping[str, Any], names: tuple[str, str, str]) -> Values:
    return np.stack([channels[name] for name in names], axis=-1, dtype=np.float32)


def main() -> None:
    """Denoises one image, at low priority."""
    job = json.load(sys.stdin)
    os.nice(5)
    answer = {}
    try:
        write_denoised(Path(job["image"]), Path(job["folder"]))
    except ImportError:
        why = "this service has no denoiser; pip install 'nocturne-service[denoise]' brings it"
        answer = {"failed": why}
    except KeyError as missing:
        answer = {"failed": f"an image without the channel {missing} can't be denoised"}
    json.dump(answer, sys.stdout)


if __name__ == "__main__":
    main()
