"""The render of the fault tests: the Cornell box, with cut tiles and a cut last range."""

import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import numpy as np
from nocturne_client import Client, Render

from tests.system.images import Image
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import LIMIT_S, wait_for

ROOT = Path(__file__).parents[2]
CORNELL = ROOT / "examples" / "cornell" / "scene.json"

WIDTH, HEIGHT = 68, 70

# 9 tiles, 8 ranges each; the last two hold more than half of the two million photons, so much is left
# to do when the first ranges are committed.
SAMPLES = 400
RANGES = 9 * 8

BRIEF_SAMPLES = 40
"""For what no fault has to hit in mid-work: a tenth of the time."""

_POLL_S = 0.15


def submit(client: Client, samples: int = SAMPLES) -> str:
    """Submits it; gives its id."""
    return client.submit(CORNELL, WIDTH, HEIGHT, samples).id


def has_ended(client: Client, render_id: str) -> bool:
    return client.get(render_id).has_ended


def is_in_mid_work(client: Client, render_id: str) -> bool:
    """Some is committed, and some is not."""
    return 0 < client.get(render_id).progress.ranges_done < RANGES


def wait_for_more_ranges(client: Client, render_id: str, ranges: int, seconds: float = LIMIT_S) -> None:
    """Waits until that many more than now are committed, or all."""
    wanted = min(RANGES, client.get(render_id).progress.ranges_done + ranges)
    wait_for(lambda: client.get(render_id).progress.ranges_done >= wanted, f"{wanted} ranges", seconds)


def finished_image(client: Client, render_id: str, samples: int = SAMPLES) -> Image:
    """Waits for the end, checks counts against the schedule; gives the service's image."""
    wait_for(lambda: has_ended(client, render_id), "the render to end")
    render = client.get(render_id)
    assert (render.state, render.reason) == ("SUCCEEDED", "")
    assert render.progress.ranges_done == render.progress.ranges_planned
    assert samples != SAMPLES or render.progress.ranges_done == RANGES
    assert render.progress.mean_samples == samples
    assert render.progress.invalid_samples == 0
    with tempfile.TemporaryDirectory() as folder:
        image = Image.read(client.download(render_id, "exr", Path(folder) / "image.exr"))
    assert image.samples.shape == (HEIGHT, WIDTH)
    assert np.all(image.samples == samples)
    return image


class FollowedRender:
    """One that is looked at all the time."""

    def __init__(self, service: ServiceProcesses, samples: int) -> None:
        self.id = submit(service.client, samples)
        self._samples = samples
        self._service = service
        self._seen: list[Render] = []
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look)
        self._thread.start()

    def finished_image(self) -> Image:
        """The service's image; checks counts against the schedule, and that nothing is left in Redis."""
        image = finished_image(self._service.client, self.id, self._samples)
        self._service.check_nothing_left()
        return image

    def stop_looking(self) -> None:
        self._over.set()
        self._thread.join()

    def check_never_went_back(self) -> None:
        """Neither totals nor previews."""
        assert len(self._seen) > 1
        _check_grows([render.sequence for render in self._seen])
        _check_grows([render.progress.samples_merged for render in self._seen])
        _check_grows([render.progress.ranges_done for render in self._seen])
        answer = httpx.get(f"{self._service.url}/v1/renders/{self.id}/convergence", trust_env=False)
        _check_grows([point["samples"] for point in answer.json()["points"]])

    def _look(self) -> None:
        with Client(self._service.url) as client:
            while not self._over.wait(_POLL_S):
                self._seen.append(client.get(self.id))


@contextmanager
def followed_render(service: ServiceProcesses, samples: int = SAMPLES) -> Iterator[FollowedRender]:
    """Submits the render; at the end, fails if merged samples, or a preview, ever went back."""
    render = FollowedRender(service, samples)
    try:
        yield render
        render.stop_looking()
        render.check_never_went_back()
    except BaseException:
        service.spoilt = True
        sys.stderr.write(service.logs())
        raise
    finally:
        render.stop_looking()


def _check_grows(values: list[int]) -> None:
    assert values
    assert values == sorted(values)
