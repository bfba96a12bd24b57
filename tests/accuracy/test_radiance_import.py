"""A room of Radiance's after its import, next to what Radiance finds."""

from pathlib import Path

import numpy as np
from nocturne_client.local.compiled import compile_to
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

from tests.accuracy.agreement import student_bound
from tests.accuracy.tracing import part_of, run

ROOM = """
void plastic floor 0 0 5 .2 .2 .2 0 0
void plastic wall 0 0 5 .5 .5 .5 0 0
void plastic ceiling 0 0 5 .7 .7 .7 0 0
void light panel 0 0 3 10 10 10
void plastic column 0 0 5 .3 .3 .3 0 0
floor polygon floor 0 0 12  0 0 0  4 0 0  4 3 0  0 3 0
ceiling polygon ceiling 0 0 12  0 0 2.8  0 3 2.8  4 3 2.8  4 0 2.8
wall polygon west 0 0 12  0 0 0  0 3 0  0 3 2.8  0 0 2.8
wall polygon east 0 0 12  4 0 0  4 0 2.8  4 3 2.8  4 3 0
wall polygon south 0 0 12  0 0 0  0 0 2.8  4 0 2.8  4 0 0
wall polygon north 0 0 12  0 3 0  4 3 0  4 3 2.8  0 3 2.8
panel polygon panel 0 0 12  0.5 1 2.79  0.5 2 2.79  1.5 2 2.79  1.5 1 2.79
column cylinder column 0 0 7  2.2 1.5 0  2.2 1.5 2.8  0.2
"""
# Means and standard errors of eight runs of rtrace (Radiance 6.0a, pyradiance 1.3.1) with -I -u+ -ab 12 -aa 0
# -ad 40000 -lw 1e-8 -dj 0.7 -ds 0.02 -dt 0 -dc 1, times 179, at these points (z up).
POINTS = [(1.0, 1.5, 0.8), (3.2, 1.5, 0.8), (3.0, 0.5, 0.8)]
SHOWN = np.array([514.15, 57.15, 139.31])
ITS_ERROR = np.array([0.21, 0.25, 0.30])


def test_a_room_has_the_light_that_radiance_finds(tmp_path: Path) -> None:
    """Below a panel, behind a column, and in a corner."""
    file = tmp_path / "room.rad"
    file.write_text(ROOM)
    found = import_scene(file, tmp_path / "made", ImportOptions())
    places = [[x, z, -y] for x, y, z in POINTS]
    meters = {"type": "meters", "instruments": [{"name": "points", "points": places}]}
    compiled = compile_to(
        found.document, tmp_path, len(POINTS), 1, part_of(32768), changes={"sensor": meters}
    )
    image, _ = run(compiled, tmp_path)
    lux, error = image.xyz[0, :, 1], image.y_stderr[0]
    # Radiance's eight runs have seven degrees of freedom.
    assert (np.abs(lux - SHOWN) <= student_bound(len(POINTS), 7) * np.hypot(error, ITS_ERROR)).all()
    assert (error < 0.02 * lux).all()
