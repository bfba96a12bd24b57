"""How long a person waits for the first light under a sky: from submit to the first tile to be shown."""

import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO
from nocturne_client import Client

from bench.report import Figures, Row
from bench.running_service import RunningService, running_service

AIM_S = 2.0
_WIDTH, _HEIGHT = 2048, 1024
_POLL_S = 0.01
_FILM = 640, 360
_SAMPLES = 64


def run(quick: bool) -> Figures:
    """The first render of a new service; then under another sky, and under the same one from elsewhere."""
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as kept:
        folder = Path(kept)
        for number in range(2):
            _write_sky(folder / f"sky-{number}.exr", number)
        with running_service(workers=1, threads=2) as service:
            return {
                "cold_s": _wait(service, folder, 0, 0.0),
                "new_sky_s": _wait(service, folder, 1, 0.0),
                "same_sky_s": [_wait(service, folder, 1, 0.1 * turn) for turn in range(1, 2 if quick else 4)],
            }


def rows(figures: Figures) -> list[Row]:
    """The three waits."""
    aim = f"at most {AIM_S:g} s"
    return [
        Row("first render of a service, sky of 2048 x 1024", f"{figures['cold_s']:.2f} s", aim),
        Row("under another sky", f"{figures['new_sky_s']:.2f} s", aim),
        Row("under the same sky, at most", f"{max(figures['same_sky_s']):.2f} s", aim),
    ]


def _wait(service: RunningService, folder: Path, sky: int, aside: float) -> float:
    scene = folder / "scene.json"
    with Client(service.url) as client:
        scene.write_text(json.dumps(_document(f"sky-{sky}.exr", aside)))
        started = time.monotonic()
        render = client.submit(scene, *_FILM, _SAMPLES)
        while not client.tiles(render.id).tiles:
            time.sleep(_POLL_S)
        waited = time.monotonic() - started
        client.cancel(render.id)
    return waited


def _write_sky(path: Path, number: int) -> None:
    """A coloured sky with a small sun; no two texels are alike, and no two skies."""
    height = np.linspace(1.0, 0.0, _HEIGHT)[:, None, None]
    sky = height * np.array([0.3, 0.5, 1.0]) + (1 - height) * np.array([0.6, 0.5, 0.4])
    grain = np.random.default_rng(number).random((_HEIGHT, _WIDTH, 3))
    image = sky * (0.9 + 0.2 * grain)
    image[300:304, 600:604] = 5e4
    written = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(_WIDTH, _HEIGHT, 3, OpenImageIO.HALF))
    written.set_pixels(OpenImageIO.ROI(), image.astype(np.float32))
    if not written.write(str(path)):
        raise OSError(f"{path}: {written.geterror()}")


def _document(sky: str, aside: float) -> dict[str, Any]:
    """A ball on a floor."""
    floor = {"type": "quad", "corner": [-5, 0, -5], "edge_u": [0, 0, 10], "edge_v": [10, 0, 0]}
    ball = {"type": "sphere", "centre": [0, 1, 0], "radius": 1}
    grey = {"type": "lambertian", "reflectance": 0.5}
    return {
        "nocturne": 1,
        "name": "first light",
        "surfaces": [{"shape": floor, "kernel": grey}, {"shape": ball, "kernel": grey}],
        "environment": {"asset": sky, "luminance": 1000},
        "sensor": {
            "type": "pinhole",
            "position": [aside, 2, 6],
            "look_at": [0, 1, 0],
            "vertical_field_of_view_degrees": 40,
        },
    }
