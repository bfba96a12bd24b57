"""What all tests of the whole service share."""

import subprocess
from pathlib import Path

import pytest

from tests.system.images import Image
from tests.system.renders import CORNELL, HEIGHT, SAMPLES, WIDTH
from tests.system.up import NOCTURNE


@pytest.fixture(scope="session")
def traced_alone(tmp_path_factory: pytest.TempPathFactory) -> Image:
    """The image of nocturne-trace, without a service: what every other way must give."""
    output = tmp_path_factory.mktemp("alone") / "image.exr"
    film = ["--width", str(WIDTH), "--height", str(HEIGHT), "--samples", str(SAMPLES)]
    subprocess.run([NOCTURNE, "render", CORNELL, "-o", Path(output), *film], check=True, capture_output=True)
    return Image.read(output)
