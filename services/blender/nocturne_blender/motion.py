"""Where everything stands while the shutter is open, at equally spaced moments of it."""

import math
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import numpy as np
from mathutils import Matrix

from .findings import Findings
from .placing import placement

Json = Any
SetFrame = Callable[[int, float], None]

# Between two of them everything moves in straight lines: of half a turn, 1.9 % inside of its arc at most.
_MOMENTS = 9
# When the shutter opens, in its own lengths from the frame.
_OPENS = {"START": 0.0, "CENTER": -0.5, "END": -1.0}
# Of matrices: less is no movement.
_STILL = 1e-6


class Movements:
    """What moves; nothing does where the scene is without motion blur."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._matrices: dict[Any, list[Any]] = defaultdict(list)

    def record(self, depsgraph: Any, set_frame: SetFrame) -> None:
        """Looks at the scene at each moment, and goes back to its frame."""
        scene = depsgraph.scene
        render = scene.render
        frame, part = scene.frame_current, scene.frame_subframe
        opens = _OPENS[getattr(render, "motion_blur_position", "CENTER")]
        for moment in np.linspace(0.0, 1.0, _MOMENTS):
            at = frame + part + float(opens + moment) * render.motion_blur_shutter
            set_frame(math.floor(at), at - math.floor(at))
            self._matrices["camera"].append(_matrix(camera_matrix(depsgraph)))
            for instance in depsgraph.object_instances:
                if instance.show_self:
                    self._matrices[key_of(instance)].append(_matrix(instance.matrix_world))
        set_frame(frame, part)

    def of(self, key: Any, matrix: Any, name: str, *, scales: bool = True) -> Json:
        """Fields of the object with this `key` at `matrix`: its motion, or none.

        `scales`: whether it may become larger or smaller meanwhile.
        """
        found = self._matrices.get(key, [])
        before = _matrix(matrix)
        if all(np.abs(each - before).max() <= _STILL for each in found):
            return {}
        if len(found) < _MOMENTS or np.linalg.det(before[:3, :3]) == 0.0:
            self._findings.lost(name, "comes or goes while the shutter is open; taken as still")
            return {}
        back = np.linalg.inv(before)
        placements = [placement(Matrix((each @ back).tolist())) for each in found]
        if any(each is None or ("scale" in each and not scales) for each in placements):
            self._findings.lost(name, "changes its shape while the shutter is open; taken as still")
            return {}
        return {"motion": {"placements": placements}}


def key_of(instance: Any) -> Any:
    """By which an instance is known again at another moment."""
    parent = instance.parent.name_full if instance.is_instance and instance.parent else ""
    return instance.object.name_full, parent, tuple(instance.persistent_id)


def camera_matrix(depsgraph: Any) -> Any:
    """Of the scene's camera, without a scale."""
    return depsgraph.scene_eval.camera.evaluated_get(depsgraph).matrix_world.normalized()


def _matrix(matrix: Any) -> Any:
    return np.array(matrix, dtype=np.float64)
