"""Bodies whose places other renderers can't have: one in another, and one across a film."""

from collections.abc import Sequence

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.film import Film
from nocturne_scene.formats.writing.compiled import Compiled, Placed, array
from nocturne_scene.formats.writing.tables import Array


def refuse_overlaps(compiled: Compiled) -> None:
    """Tell of bodies that may overlap: boundaries of other renderers must not."""
    bodies = list(compiled.bodies())
    boxes = _boxes(compiled, bodies)
    for at, body in enumerate(bodies):
        low, high = np.maximum(boxes[at, 0], boxes[:at, 0]), np.minimum(boxes[at, 1], boxes[:at, 1])
        for other in np.flatnonzero(np.all(high > low, axis=1)):
            compiled.findings.lost(
                body.place,
                f"may overlap with {bodies[other].place}, and bodies that do can't be exported",
            )


def _boxes(compiled: Compiled, bodies: Sequence[Placed]) -> Array:
    """The lowest and highest corners of the boxes around bodies, shape (bodies, 2, 3)."""
    known: dict[int, Array] = {}
    boxes = np.empty((len(bodies), 2, 3))
    for at, body in enumerate(bodies):
        if id(body.surface) not in known:
            known[id(body.surface)] = np.stack(compiled.bounds(body.surface, body.place), axis=1)
        corners = np.stack(np.meshgrid(*known[id(body.surface)]), axis=-1).reshape(-1, 3)
        placed = corners @ body.placement[:, :3].T + body.placement[:, 3]
        boxes[at] = placed.min(axis=0), placed.max(axis=0)
    return boxes


def refuse_bodies_across_film(compiled: Compiled, film: Film) -> None:
    """Tell of media in which only a part of a film may lie: sensors of other renderers are in one."""
    sensor = compiled.message.sensor
    if sensor.model not in (scene_pb2.SENSOR_MODEL_PLANE, scene_pb2.SENSOR_MODEL_ORTHOGRAPHIC):
        return
    half = 0.5 * compiled.metre * sensor.height
    across, down = half * film.width / film.height * array(sensor.right), half * array(sensor.up)
    corners = compiled.point(sensor.position) + np.array(
        [i * across + j * down for i in (-1, 1) for j in (-1, 1)]
    )
    low, high = corners.min(axis=0), corners.max(axis=0)
    bodies = list(compiled.bodies())
    for body, box in zip(bodies, _boxes(compiled, bodies), strict=True):
        filled = compiled.body(body.surface, body.place)
        if filled is None or filled.is_empty or np.any(box[0] > high) or np.any(box[1] < low):
            continue
        turned, base = body.placement[:, :3], body.placement[:, 3]
        inside = (np.asarray(np.linalg.solve(turned, each - base)) for each in corners)
        if not all(compiled.encloses(body.surface, each, body.place) for each in inside):
            compiled.findings.lost(
                "$.sensor",
                f"a part of its film may lie in {body.place}, and a film in two media can't be exported",
            )
