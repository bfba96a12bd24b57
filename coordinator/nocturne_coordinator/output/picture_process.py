"""A program: the pictures of one render from its committed sums, and their error.

    python -m nocturne_coordinator.output.picture_process DATA RENDER FOLDER [--final]

Large films take a minute and gigabytes: this is not the coordinator's time, nor its memory."""

import ctypes
import json
import os
import resource
import signal
import sys
import time
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

from nocturne_scene.replacing import sync

from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.output.pictures import ANSWER, write_pictures
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.open_renders import find_render, tiles_of

_MEMORY, _MEMORY_PER_PIXEL = 2**32, 600
"""Bytes of address space, libraries included: twice what sums and EXR of the largest films take."""

_PR_SET_PDEATHSIG = 1


def main() -> int:
    data, render_id, place = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    final = sys.argv[4:] == ["--final"]
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    os.nice(5)
    # Where memory is short, this process goes and not the coordinator.
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")
    folder = DataFolder(data)
    # As all of it is now, whatever is committed meanwhile.
    with folder.database.snapshot():
        row = find_render(folder.database, render_id)
        if row is None:
            return 1
        most = _MEMORY + _MEMORY_PER_PIXEL * row.schedule.width * row.schedule.height
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        render = RunningRender(row, tiles_of(folder.database, render_id))
    render.is_alone = True
    written = write_pictures(folder, render, place, final)
    if final:
        for path in written:
            sync(path)
    point, _ = render.error_point(time.time())
    answer = {
        "photons": render.totals.photons,
        "point": asdict(point),
        "estimate": asdict(render.estimate),
        "cpu_seconds": time.process_time(),
    }
    (place / ANSWER).write_text(json.dumps(answer))
    return 0


if __name__ == "__main__":
    sys.exit(main())
