"""Where the time goes from the press of Render to the first tile: submission, start, first samples, download.

As the page does it: the render is created, its events are followed, and tiles fetched that an event names.
"""

import json
import secrets
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import httpx

from bench.report import Figures, Row, spread, spread_text
from bench.running_service import RunningService, running_service
from bench.scenes import CORNELL

AIM_S = 1.2
THREADS = 2
_EDGE, _SAMPLES = 512, 100_000
_FEW_SAMPLES = 4
"""So few that no pilot runs."""
_PATIENCE_S = 60.0


@dataclass(frozen=True)
class FirstTile:
    """Seconds since Render was pressed, one after the other."""

    submitted: float
    """The service has answered: checked, compiled, the way chosen by a pilot, queued."""
    started: float
    """A coordinator has taken the render up."""
    first_samples: float
    """An event names tiles with samples."""
    downloaded: float
    """And these are here."""

    def parts(self) -> dict[str, float]:
        """What each took after the one before."""
        moments = asdict(self)
        before = [0.0, *moments.values()]
        return {name: at - since for (name, at), since in zip(moments.items(), before, strict=False)}


def run(quick: bool) -> Figures:
    """A service with one worker of two threads, idle but for this; each scene is new to it."""
    rounds = 1 if quick else 5
    with running_service(workers=1, threads=THREADS) as service:
        _first_tile(service, _SAMPLES, [])
        plain = [_first_tile(service, _SAMPLES, []) for _ in range(rounds)]
        layered = [_first_tile(service, _SAMPLES, ["albedo", "depth"]) for _ in range(rounds)]
        unpiloted = [_first_tile(service, _FEW_SAMPLES, []) for _ in range(rounds)]
    parts = [each.parts() for each in layered]
    return {
        "first_tile_s": spread([each.downloaded for each in plain]),
        "with_layers_s": spread([each.downloaded for each in layered]),
        "without_pilot_s": spread([each.downloaded for each in unpiloted]),
        "parts_s": {name: spread([each[name] for each in parts]) for name in parts[0]},
    }


def rows(figures: Figures) -> list[Row]:
    """The wait as a whole, with layers and without a pilot, and its parts."""
    parts = ", ".join(f"{name} {spread_text(each)}" for name, each in figures["parts_s"].items())
    return [
        Row("Render to first tile, s", spread_text(figures["first_tile_s"]), f"at most {AIM_S}"),
        Row("with two layers, s", spread_text(figures["with_layers_s"]), f"at most {AIM_S}"),
        Row("so few samples that no pilot runs, s", spread_text(figures["without_pilot_s"])),
        Row("parts with layers, s", parts),
    ]


def _first_tile(service: RunningService, samples: int, layers: list[str]) -> FirstTile:
    document: dict[str, Any] = json.loads(CORNELL.read_text())
    # Another scene for workers and store; the photons are others, their cost is the same.
    document["tracing"] = {**document.get("tracing", {}), "seed": secrets.randbelow(2**31)}
    body = {
        "request_id": secrets.token_hex(8),
        "name": "first tile",
        "scene": document,
        "width": _EDGE,
        "height": _EDGE,
        "samples": samples,
        "layers": layers,
    }
    with httpx.Client(base_url=service.url, timeout=_PATIENCE_S) as client:
        pressed = time.time()
        made = client.post("/v1/renders", json=body).raise_for_status().json()
        submitted = time.time() - pressed
        started = first_samples = 0.0
        with client.stream("GET", "/v1/events", params={"render": made["id"]}) as events:
            for kind, data in _events(events):
                if kind == "render" and data["started"]:
                    started = max(submitted, data["started"] - pressed)
                if kind == "tiles":
                    first_samples = time.time() - pressed
                    break
        client.get(f"/v1/renders/{made['id']}/tiles").raise_for_status()
        downloaded = time.time() - pressed
        client.post(f"/v1/renders/{made['id']}:cancel")
        _rest(client)
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


def _rest(client: httpx.Client) -> None:
    """Waits until no worker traces, and layers that are on the way are there."""
    end = time.monotonic() + _PATIENCE_S
    while time.monotonic() < end:
        if all(each["rays_per_second"] == 0 for each in client.get("/v1/workers").json()["workers"]):
            break
        time.sleep(0.1)
    time.sleep(2.0)
