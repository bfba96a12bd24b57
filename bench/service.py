"""CPU and wall time of a render by the service against nocturne-trace with the same schedule."""

import statistics
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from nocturne_client import Client
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import compile_to

from bench.programs import Channel, Traced, read_image, trace
from bench.report import Figures, Row, significant, spread, spread_text
from bench.running_service import RunningService, running_service
from bench.scenes import CORNELL

AIM = 1.03
THREADS = 2
_POLL_S = 0.01


@dataclass(frozen=True)
class Served:
    """A render by the service: seconds from the call of submit to the final state."""

    xyz: Channel
    cpu_s: dict[str, float]
    """By process, `nocturne up` itself included."""
    wall_s: float
    first_preview_s: float


def run(quick: bool) -> Figures:
    """The service has one worker of two threads and is warm: it has rendered this scene before."""
    edge, samples, rounds = (128, 64, 1) if quick else (512, 128, 3)
    served: list[Served] = []
    traced: list[Traced] = []
    with (
        tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder,
        running_service(workers=1, threads=THREADS) as service,
    ):
        compiled = compile_to(CORNELL, Path(folder), edge, edge, samples)
        _serve(service, Path(folder), 64, 4)
        for _ in range(rounds):
            served.append(_serve(service, Path(folder), edge, samples))
            traced.append(trace(compiled, THREADS))
            _check_same(served[-1].xyz, traced[-1].xyz)
    return _figures(served, traced)


def rows(figures: Figures) -> list[Row]:
    """The ratios, who uses the time, and the wait for a first picture."""
    shares = sorted(figures["cpu_share"].items(), key=lambda item: -item[1])
    parts = ", ".join(f"{name} {100 * share:.2g} %" for name, share in shares)
    return [
        Row("CPU time, service / nocturne-trace", spread_text(figures["cpu_ratio"]), f"at most {AIM}"),
        Row("wall time, service / nocturne-trace", spread_text(figures["wall_ratio"])),
        Row("CPU time of the service by process", parts),
        Row("submit to first preview, s", spread_text(figures["first_preview_s"])),
    ]


def _figures(served: list[Served], traced: list[Traced]) -> Figures:
    totals = [sum(each.cpu_s.values()) for each in served]
    pairs = list(zip(served, totals, traced, strict=True))
    return {
        "photons": traced[0].photons,
        "cpu_ratio": spread([total / alone.process_cpu_s for _, total, alone in pairs]),
        "wall_ratio": spread([each.wall_s / alone.process_wall_s for each, _, alone in pairs]),
        "service_cpu_s": spread(totals),
        "trace_cpu_s": spread([each.process_cpu_s for each in traced]),
        "first_preview_s": spread([each.first_preview_s for each in served]),
        "cpu_share": {
            name: significant(statistics.median(each.cpu_s[name] / total for each, total, _ in pairs))
            for name in served[0].cpu_s
        },
    }


def _serve(service: RunningService, folder: Path, edge: int, samples: int) -> Served:
    with Client(service.url) as client, ThreadPoolExecutor(1) as beside:
        cpu_before, start = service.cpu_s(), time.monotonic()
        render = client.submit(CORNELL, edge, edge, samples)
        over = threading.Event()
        preview = service.data / "images" / render.id / "preview.png"
        first_preview = beside.submit(_time_of, preview, over)
        *_, render = client.watch(render.id)
        wall_s, cpu_after = time.monotonic() - start, service.cpu_s()
        over.set()
        if render.state != "SUCCEEDED":
            raise NocturneClientError(f"the render is {render.state}: {render.reason}")
        xyz, _ = read_image(client.download(render.id, "exr", folder / "service.exr"))
    cpu_s = {name: cpu_after[name] - cpu_before[name] for name in cpu_after}
    return Served(xyz, cpu_s, wall_s, first_preview.result() - start)


def _time_of(path: Path, over: threading.Event) -> float:
    """When the file appeared; looked for on disk, so that the service is not asked."""
    while not path.exists() and not over.wait(_POLL_S):
        pass
    return time.monotonic()


def _check_same(service: Channel, alone: Channel) -> None:
    if not np.array_equal(service, alone):
        raise NocturneClientError(
            "the service and nocturne-trace give different images: times can't be compared"
        )
