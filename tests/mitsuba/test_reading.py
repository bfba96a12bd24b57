"""Every EXR that we write, as Mitsuba's Bitmap reads it: the same channels and numbers as OpenImageIO.

The local tracer's writer, the coordinator's, that of layers, and that of denoised pictures with their map in
error bars.
"""

import json
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_api.children import denoising as pictures
from nocturne_client.cli.app import app
from nocturne_client.local.programs import CHECKOUT
from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.output.images import Provenance, write_image
from nocturne_scene.layers import CHANNELS, write_layers
from nocturne_scene.tile_sums import PRODUCTS, sums_per_pixel
from typer.testing import CliRunner

PYTHON = CHECKOUT / "build" / "peers" / "bin" / "python"

pytestmark = [
    pytest.mark.peers,
    pytest.mark.skipif(not PYTHON.exists(), reason=f"needs Mitsuba in {PYTHON.parents[1]}: `make peers`"),
]

READ = """
import json, sys
import mitsuba
import numpy as np
mitsuba.set_variant("scalar_rgb")
bitmap = mitsuba.Bitmap(sys.argv[1])
fields = bitmap.struct_()
pixel = np.array(bitmap)[5, 3]
print(json.dumps({fields[i].name: float(pixel[i]) for i in range(len(fields))}))
"""


def test_all_kinds_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = CHECKOUT / "examples" / "cornell" / "scene.json"

    def run(*words: str | Path) -> None:
        result = CliRunner().invoke(app, [str(word) for word in words])
        assert result.exit_code == 0, result.output

    kinds = {
        "layers": ("--layers", "all"),
        "bands": ("--bands", "400:700:50"),
        "parts": ("--layers", "direct,indirect"),
    }
    for name, options in kinds.items():
        film = ("--width", "16", "--height", "16", "--samples", "8")
        run("render", scene, "-o", tmp_path / f"{name}.exr", *film, *options)
    files = [tmp_path / f"{name}.exr" for name in kinds]
    # The test reads only the file, so any denoiser will do.
    monkeypatch.setattr(pictures, "denoised", lambda channels: np.dstack([channels[name] for name in "RGB"]))
    pictures.write_denoised(files[0], tmp_path)
    squares = Squares(np.zeros((1, 1, PRODUCTS)), np.zeros((1, 1, PRODUCTS)), 8)
    sums = np.random.default_rng(1).random((8, 8, sums_per_pixel(0)))
    provenance = Provenance("00", "{}", 1, error_warning="brighter samples are still met")
    write_image(tmp_path / "service.exr", sums, np.full((8, 8), 4, np.uint32), squares, provenance)
    write_layers(tmp_path / "pass.exr", [*CHANNELS], np.ones((8, 8, 13), np.float32), "[]")
    files += [tmp_path / name for name in (pictures.EXR, "service.exr", "pass.exr")]
    for file in files:
        told = subprocess.run([PYTHON, "-c", READ, file], capture_output=True, text=True, check=True).stdout
        image = oiio.ImageBuf(str(file))
        ours = dict(zip(image.spec().channelnames, image.getpixel(3, 5), strict=True))
        # Whole numbers, which OpenImageIO gives as parts of the largest.
        if "n" in ours:
            ours["n"] *= 2**32 - 1
        assert {name: pytest.approx(value, rel=1e-6) for name, value in ours.items()} == json.loads(told)
