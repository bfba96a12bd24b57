"""Every bound on what the service accepts and keeps, with its reason. Of scenes: `nocturne_scene.limits`."""

# --- what a render may ask for ---

MAX_REQUEST_ID = 128
"""Characters: room for a UUID and a prefix."""

MAX_NAME = 200
"""Characters: a title, not a text."""

MAX_REASON = 1000
"""Characters kept of a failure's reason; workers write it, so it is cut."""

MAX_PAGE = 200
DEFAULT_PAGE = 50
"""Renders in one answer: a page stays below 200 KiB."""

IDS_SHOWN = 8
"""Of renders whose ids begin as somebody asked: enough to see which character comes next."""

MAX_ERROR_ASKED = 1.0
"""Relative: above it, nothing is known of an image."""

MAX_SECONDS_ASKED = 366 * 86400.0
"""A year: a time that is further ahead is a slip."""

DEFAULT_PRIORITY = 100
MAX_PRIORITY = 1000
"""Weights: a render of priority 200 gets twice the work of one of 100."""

# --- what the coordinator keeps in hand ---

MAX_RUNNING = 8
"""Renders that share the workers; later ones wait as QUEUED."""

MAX_NEWCOMERS = 8
"""Renders beyond that, each of an owner who has none at work: nobody waits for others' renders to end."""

MAX_RUNNING_SUMS = 2**28
"""Numbers that the running renders of an owner who is alone may hold, 8 bytes each: 2 GiB. All owners hold
less than twice that, as nobody may hold more than half of what the others leave."""

SUMS_PART_OF_MEMORY = 0.4
"""Of the coordinator's memory, that all those sums may take where it has little."""

PICTURE_BYTES = 112
"""For each pixel, that the process which makes the pictures of a large film needs in addition to a copy of
its sums: 25 channels of an EXR, the numbers of samples, and some rows as they are made."""

MEMORY_BESIDE = 2**29
"""Bytes of the coordinator's memory for all but films: libraries, and results that wait."""

MAX_LOOKED_AT_PIXELS = 2**21
"""Of films whose error and live picture the coordinator finds itself, in half a second of 1920 x 1080. Of
larger ones a process does, while results of all are merged."""

MAX_NEXT_OF_OWNER = 2 * MAX_RUNNING
"""Queued renders of one owner that the coordinator looks at: more can't be taken up at once, and an owner may
have thousands."""

MIN_WINDOW = 16
JOBS_PER_THREAD = 4
"""Jobs in flight: enough that no thread waits for the coordinator, never the whole night."""

MAX_WINDOW = 40_000
"""10,000 threads' worth: 1.3 GiB of waiting partials at the very worst, twice that with further responses."""

RANGES_AHEAD = 4
"""Ranges of one tile that may be in flight or wait for an earlier one; bounds what a slow worker holds up."""

MAX_PHOTON_BYTES = 2**28
"""Of the results of one render's ranges of forward photons that wait in Redis; see photon_ranges_ahead."""

_PHOTON_BYTES_PER_PIXEL = 16
"""Measured, of a film that is lit all over: 25 bytes are packed to 12 to 15 (decision 0074)."""


def photon_ranges_ahead(pixels: int) -> int:
    """RANGES_AHEAD of forward photons, of which a result is as large as the film: 8 of two million pixels."""
    return max(2, min(32, MAX_PHOTON_BYTES // (_PHOTON_BYTES_PER_PIXEL * pixels)))


MAX_QUICK_PHOTONS = 2**16
"""Of a render whose jobs may have quick copies: 0.07 s of a processor, as the example scenes cost."""

MAX_QUICK_COPIES = 64
"""That are out at once, and no more than there are workers: each takes one at a time."""

QUICK_CPU_SECONDS = 1.0
"""Processor time after which a quick copy is stopped."""

QUICK_REFUSED_SECONDS = 60.0
"""For which the owner of such a render gets no quick copies: a second of one thread in a minute, at most."""

DISTINCT_WORKERS = 3
"""Workers that failed at a job before it is given up: the third says it isn't the worker's fault."""

DISTINCT_JOBS = 3
"""Jobs that a worker failed at and others did before it is quarantined: the third says it isn't the job's."""

MAX_FAILED_TILES = 8
"""Tiles that failed before the render fails: its scene, not a tile, is at fault."""

MAX_AUDITS = 1000
"""Jobs that wait for a second opinion; the rest of the share is let go rather than piled up."""

MAX_RAYS_PER_PHOTON = 2**20
"""No path is longer; keeps a wrong count from overflowing the sums of counts."""

MAX_MACHINES_OF_TOKEN = 4096
"""Each is a user of Redis."""

DISTINCT_LIARS = 3
"""Machines of one token that are found faulty within a day before all of its are in quarantine: who holds it
may give them any names."""

MAX_THREADS = 4096
"""Of a machine: none has more."""

WORKER_SECONDS = 10.0
"""A worker that was not heard of for so long is not listed."""
