"""Every bound on the size of films, scenes and the files of scenes, each with its reason."""

# --- what a film may ask for ---

MAX_FILM_EDGE = 16384
"""Pixels. An 8K wall display is 7680; the tile index and EXR tools stay comfortable."""

MAX_FILM_PIXELS = 2**26
"""Of an image with X, Y and Z only: the coordinator holds 32 bytes of sums per pixel in memory while a render
runs, 2 GiB here. Every further response costs 8 bytes more, and so pixels."""

MAX_FURTHER_RESPONSES = 60
"""With those, a pixel has 64 sums and the smallest tile's partial fills 32 KiB."""

MAX_FORWARD_PIXELS = 4096**2
"""With photons from luminaires: a worker's thread holds the sums of the whole film, 1.2 GiB here."""

MAX_FORWARD_RANGES = 2**20
"""Ranges of a schedule with photons from luminaires; as many as the other schedules have at most, and
some."""

MAX_SAMPLES = 2**31
"""Per pixel: the sampler's index is 32 bits, and nothing on paper needs more."""

MAX_RANGES = 2**31
"""Tiles x ranges of a schedule: counts of ranges travel as uint32."""

# --- what a scene may hold ---

MAX_SCENE_BYTES = 8 * 2**20
"""A scene document; large meshes are assets, never inline."""

MAX_SCENE_NESTING = 64
"""Levels of JSON: the schema needs fewer than 10, and recursion stays far from the stack's end."""

MAX_VERTICES = 200_000_000
MAX_TRIANGLES = 200_000_000
"""Of one mesh: indices are 32 bits, and Embree's tree of it fills some 20 GiB."""

MAX_ASSET_BYTES = 4 * 2**30
"""One blob: 200 million triangles of 12 bytes of indices fit."""
