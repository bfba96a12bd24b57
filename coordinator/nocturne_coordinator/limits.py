"""Every bound on what is accepted and kept, each with its reason."""

# --- what a render may ask for ---

MAXIMUM_FILM_EDGE = 16384
"""Pixels. An 8K wall display is 7680; the tile index and EXR tools stay comfortable."""

MAXIMUM_FILM_PIXELS = 2**26
"""Of an image with X, Y and Z only: the coordinator holds 32 bytes of sums per pixel in memory while a render
runs, 2 GiB here. Every further response costs 8 bytes more, and so pixels."""

MAXIMUM_FURTHER_RESPONSES = 60
"""With those, a pixel has 64 sums and the smallest tile's partial fills 32 KiB."""

MAXIMUM_FORWARD_PIXELS = 2**18
"""With photons from luminaires a job returns the whole film: 8 MiB here; 512 x 512 or 1 degree apart."""

MAXIMUM_FORWARD_RANGES = 2**20
"""Ranges of a plan with photons from luminaires; as many as the other plans have at most, and some."""

MAXIMUM_SAMPLES = 2**31
"""Per pixel: the sampler's index is 32 bits, and nothing on paper needs more."""

MAXIMUM_RANGES = 2**31
"""Tiles x ranges of a plan: counts of ranges travel as uint32."""

MAXIMUM_REQUEST_ID = 128
"""Characters: room for a UUID and a prefix."""

MAXIMUM_NAME = 200
"""Characters: a title, not a text."""

MAXIMUM_REASON = 1000
"""Characters kept of a failure's reason; workers write it, so it is cut."""

MAXIMUM_PAGE = 200
DEFAULT_PAGE = 50
"""Renders in one answer: a page stays below 200 KiB."""

MAXIMUM_ERROR_ASKED = 1.0
"""Relative: above it, nothing is known of an image."""

MAXIMUM_SECONDS_ASKED = 366 * 86400.0
"""A year: a time that is further ahead is a slip."""

DEFAULT_PRIORITY = 100
MAXIMUM_PRIORITY = 1000
"""Weights: a render of priority 200 gets twice the work of one of 100."""

# --- what a scene may hold ---

MAXIMUM_SCENE_BYTES = 8 * 2**20
"""A scene document; large meshes are assets, never inline."""

MAXIMUM_SCENE_NESTING = 64
"""Levels of JSON: the schema needs fewer than 10, and recursion stays far from the stack's end."""

MAXIMUM_VERTICES = 200_000_000
MAXIMUM_TRIANGLES = 200_000_000
"""Of one mesh: indices are 32 bits, and Embree's tree of it fills some 20 GiB."""

MAXIMUM_ASSET_BYTES = 4 * 2**30
"""One blob: 200 million triangles of 12 bytes of indices fit."""

# --- what the coordinator keeps in hand ---

MAXIMUM_RUNNING = 8
"""Renders that share the workers; later ones wait as QUEUED."""

MAXIMUM_RUNNING_SUMS = 2**28
"""Of all running renders together, 8 bytes each: bounds memory to 2 GiB of sums."""

MINIMUM_WINDOW = 16
JOBS_PER_THREAD = 4
"""Jobs in flight: enough that no thread waits for the coordinator, never the whole night."""

MAXIMUM_WINDOW = 40_000
"""10,000 threads' worth: 1.3 GiB of waiting partials at the very worst, twice that with further responses."""

RANGES_AHEAD = 4
"""Ranges of one tile that may be in flight or wait for an earlier one; bounds what a slow worker holds up."""

DISTINCT_WORKERS = 3
"""Workers that failed at a job before it is set aside: the third says it isn't the worker's fault."""

DISTINCT_JOBS = 3
"""Jobs that a worker failed at and others did before it is quarantined: the third says it isn't the job's."""

MAXIMUM_SET_ASIDE = 8
"""Tiles set aside before the render fails: its scene, not a tile, is at fault."""

MAXIMUM_AUDITS = 1000
"""Jobs that wait for a second opinion; the rest of the share is let go rather than piled up."""

MAXIMUM_RAYS_PER_PHOTON = 2**20
"""No path is longer; keeps a wrong count from overflowing the sums of counts."""

WORKER_SECONDS = 10.0
"""A worker that was not heard of for so long is not listed."""
