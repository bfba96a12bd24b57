"""Every EXR that we write, as Mitsuba's Bitmap reads it: the same channels and numbers as OpenImageIO."""

import json
import subprocess
from pathlib import Path

import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_client.cli.app import app
from nocturne_client.local.programs import CHECKOUT
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


def test_all_kinds_are_read(tmp_path: Path) -> None:
    scene = CHECKOUT / "examples" / "cornell" / "scene.json"

    def run(*words: str | Path) -> None:
        result = CliRunner().invoke(app, [str(word) for word in words])
        assert result.exit_code == 0, result.output

    kinds = {
        "layers": ("--layers", "all"),
        "bands": ("--bands", "400:700:50"),
        "direct": ("--set", "tracing.maximum_depth=1"),
    }
    for name, options in kinds.items():
        film = ("--width", "16", "--height", "16", "--samples", "8")
        run("render", scene, "-o", tmp_path / f"{name}.exr", *film, *options)
    files = [tmp_path / f"{name}.exr" for name in (*kinds, "parts")]
    run("light-parts", files[0], tmp_path / "direct.exr", "-o", files[-1])
    for file in files:
        told = subprocess.run([PYTHON, "-c", READ, file], capture_output=True, text=True, check=True).stdout
        image = oiio.ImageBuf(str(file))
        ours = dict(zip(image.spec().channelnames, image.getpixel(3, 5), strict=True))
        # Whole numbers, which OpenImageIO gives as parts of the largest.
        if "n" in ours:
            ours["n"] *= 2**32 - 1
        assert {name: pytest.approx(value, rel=1e-6) for name, value in ours.items()} == json.loads(told)
