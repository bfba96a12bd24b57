"""Where the time goes from the press of Render to the first tile: submission, start, first samples, download.

As the page does it: the render is created, its events are followed, and tiles fetched that an event names.
Scenes are a Cornell box, and a ball under a sky of two million texels, whose tables take a second to make.
"""

import json
import secrets
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import OpenImageIO
from nocturne_client import Client

from bench.report import Figures, Row, spread, spread_text
from bench.running_service import RunningService, running_service
from bench.scenes import Document, cornell

AIM_S, SKY_AIM_S = 1.2, 2.0
THREADS = 2
_FILM, _SAMPLES = (512, 512), 100_000
_OPEN: Mapping[str, Any] = {}
_NAMED: Mapping[str, Any] = {"direction": "adjoint", "sharing": 16}
"""What a pilot says of the Cornell box, so that none runs."""
_SKY = 2048, 1024
_PATIENCE_S = 60.0


@dataclass(frozen=True)
class FirstTile:
    """Seconds since Render was pressed, one after the other."""

    submitted: float
    """The service has answered: checked, compiled, the method chosen by a pilot, queued."""
    started: float
    """A coordinator has taken the render up."""
    first_samples: float
    """An event names tiles with samples."""
    downloaded: float
    """And these are here."""

    def parts(self) -> dict[str, float]:
        """Seconds that each step took after the one before."""
        moments = asdict(self)
        before = [0.0, *moments.values()]
        return {name: at - since for (name, at), since in zip(moments.items(), before, strict=False)}


def run(quick: bool) -> Figures:
    """A service with one worker of two threads, idle but for this; each scene is new to it."""
    rounds = 1 if quick else 5
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as kept:
        scene = Path(kept) / "scene.json"
        for number in range(2):
            _write_sky(Path(kept) / f"sky-{number}.exr", number)
        with running_service(workers=1, threads=THREADS) as service:
            skies = [_under_sky(service, scene, number, 0) for number in (0, 1)]
            same_sky = [_under_sky(service, scene, 1, turn) for turn in range(1, 1 + rounds)]
        with running_service(workers=1, threads=THREADS) as service:
            _cornell(service, scene)
            plain = [_cornell(service, scene) for _ in range(rounds)]
            layered = [_cornell(service, scene, ["albedo", "depth"]) for _ in range(rounds)]
            unpiloted = [_cornell(service, scene, tracing=_NAMED) for _ in range(rounds)]
    parts = [each.parts() for each in layered]
    return {
        "first_tile_s": spread([each.downloaded for each in plain]),
        "with_layers_s": spread([each.downloaded for each in layered]),
        "without_pilot_s": spread([each.downloaded for each in unpiloted]),
        "parts_s": {name: spread([each[name] for each in parts]) for name in parts[0]},
        "first_sky_s": skies[0].downloaded,
        "new_sky_s": skies[1].downloaded,
        "same_sky_s": spread([each.downloaded for each in same_sky]),
    }


def rows(figures: Figures) -> list[Row]:
    """The wait as a whole, with layers and without a pilot, its parts, and the waits under skies."""
    parts = ", ".join(f"{name} {spread_text(each)}" for name, each in figures["parts_s"].items())
    aim, sky_aim = f"at most {AIM_S}", f"at most {SKY_AIM_S:g}"
    return [
        Row("Render to first tile, s", spread_text(figures["first_tile_s"]), aim),
        Row("with two layers, s", spread_text(figures["with_layers_s"]), aim),
        Row("with a named method, without a pilot, s", spread_text(figures["without_pilot_s"])),
        Row("parts with layers, s", parts),
        Row(
            "first render, under a sky of 2048 x 1024, s",
            f"{figures['first_sky_s']:.3g}",
            sky_aim,
        ),
        Row("then under another sky, s", f"{figures['new_sky_s']:.3g}", sky_aim),
        Row("under the same sky from elsewhere, s", spread_text(figures["same_sky_s"]), sky_aim),
    ]


def _cornell(
    service: RunningService, scene: Path, layers: Sequence[str] = (), tracing: Mapping[str, Any] = _OPEN
) -> FirstTile:
    document = cornell()
    # Another scene for workers and store; the photons are others, their cost is the same.
    document["tracing"] = {**document.get("tracing", {}), **tracing, "seed": secrets.randbelow(2**31)}
    scene.write_text(json.dumps(document))
    return _first_tile(service, scene, layers)


def _under_sky(service: RunningService, scene: Path, sky: int, turn: int) -> FirstTile:
    """A ball on a floor, seen from another place each turn."""
    floor = {"type": "quad", "corner": [-5, 0, -5], "edge_u": [0, 0, 10], "edge_v": [10, 0, 0]}
    ball = {"type": "sphere", "centre": [0, 1, 0], "radius": 1}
    grey = {"type": "lambertian", "reflectance": 0.5}
    document: Document = {
        "nocturne": 1,
        "name": "first light",
        "surfaces": [{"shape": floor, "kernel": grey}, {"shape": ball, "kernel": grey}],
        "environment": {"asset": f"sky-{sky}.exr", "luminance": 1000},
        "sensor": {
            "type": "pinhole",
            "position": [0.1 * turn, 2, 6],
            "look_at": [0, 1, 0],
            "vertical_field_of_view_degrees": 40,
        },
    }
    scene.write_text(json.dumps(document))
    return _first_tile(service, scene, ())


def _write_sky(path: Path, number: int) -> None:
    """A coloured sky with a small sun; no two texels are alike, and no two skies."""
    width, height = _SKY
    up = np.linspace(1.0, 0.0, height)[:, None, None]
    sky = up * np.array([0.3, 0.5, 1.0]) + (1 - up) * np.array([0.6, 0.5, 0.4])
    grain = np.random.default_rng(number).random((height, width, 3))
    image = sky * (0.9 + 0.2 * grain)
    image[300:304, 600:604] = 5e4
    written = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(width, height, 3, OpenImageIO.HALF))
    written.set_pixels(OpenImageIO.ROI(), image.astype(np.float32))
    if not written.write(str(path)):
        raise OSError(f"{path}: {written.geterror()}")


def _first_tile(service: RunningService, scene: Path, layers: Sequence[str]) -> FirstTile:
    with Client(service.url) as client, httpx.Client(base_url=service.url, timeout=_PATIENCE_S) as http:
        pressed = time.time()
        made = client.submit(scene, *_FILM, _SAMPLES, layers=layers)
        submitted = time.time() - pressed
        started = first_samples = 0.0
        with http.stream("GET", "/v1/events", params={"render": made.id}) as events:
            for kind, data in _events(events):
                if kind == "render" and data["started"]:
                    started = max(submitted, data["started"] - pressed)
                if kind == "tiles":
                    first_samples = time.time() - pressed
                    break
        http.get(f"/v1/renders/{made.id}/tiles").raise_for_status()
        downloaded = time.time() - pressed
        client.cancel(made.id)
        _rest(http)
    return FirstTile(submitted, started, first_samples, downloaded)


def _events(stream: httpx.Response) -> Iterator[tuple[str, Any]]:
    """Kind and data of each."""
    kind = ""
    for line in stream.iter_lines():
        field, _, value = line.partition(": ")
        if field == "event":
            kind = value
        elif field == "data":
            yield kind, json.loads(value)


def _rest(http: httpx.Client) -> None:
    """Waits until no worker traces, and layers in progress are finished."""
    end = time.monotonic() + _PATIENCE_S
    while time.monotonic() < end:
        if all(each["rays_per_second"] == 0 for each in http.get("/v1/workers").json()["workers"]):
            break
        time.sleep(0.1)
    time.sleep(2.0)
