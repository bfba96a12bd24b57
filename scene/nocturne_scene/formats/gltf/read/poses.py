"""Where nodes are and which shapes meshes have, at rest or at a moment of the file's first animation."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read.container import Container, Json, floats, value
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.transforms import Matrix

_Array = NDArray[np.float64]

_PATHS = {"translation": 3, "rotation": 4, "scale": 3, "weights": 0}


@dataclass
class Poses:
    """The values that an animation gives to nodes, by node and property."""

    container: Container
    _animated: dict[tuple[int, str], list[float]] = field(default_factory=dict)

    def matrix(self, index: int, entry: Json, place: str) -> Matrix:
        """From a node's coordinates to those of the node above."""
        moved = any((index, path) in self._animated for path in ("translation", "rotation", "scale"))
        if "matrix" in entry and not moved:
            identity = transforms.IDENTITY.ravel().tolist()
            return np.array(floats(self.container, entry, "matrix", identity, place)).reshape(4, 4).T
        turn = transforms.IDENTITY.copy()
        quaternion = self._property(index, entry, "rotation", [0.0, 0.0, 0.0, 1.0], place)
        if any(quaternion[:3]):
            turn[:3, :3] = Rotation.from_quat(quaternion).as_matrix()
        shift = transforms.translation(self._property(index, entry, "translation", [0.0] * 3, place))
        size = transforms.scaling(self._property(index, entry, "scale", [1.0] * 3, place))
        return np.asarray(shift @ turn @ size)

    def weights(self, index: int, entry: Json, mesh: Json, count: int, place: str) -> list[float]:
        """How much of each of `count` morph targets is added: of the animation, the node or the mesh."""
        if (index, "weights") in self._animated:
            found = self._animated[index, "weights"]
            if len(found) != count:
                raise InputError.at(self.container.at(place), f"{len(found)} weights; expected {count}")
            return found
        return floats(self.container, entry if "weights" in entry else mesh, "weights", [0.0] * count, place)

    def _property(self, index: int, entry: Json, path: str, default: list[float], place: str) -> list[float]:
        if (index, path) in self._animated:
            return self._animated[index, path]
        return floats(self.container, entry, path, default, place)


def poses_at(container: Container, findings: Findings, time: float | None) -> Poses:
    """The poses of a file at a time in seconds; None: at rest. Raises InputError."""
    animations = value(container.tree, "animations", [])
    if not animations:
        if time is not None:
            findings.note("", "the file has no animation: it is the same at all times")
        return Poses(container)
    if time is None:
        findings.note(
            container.shown,
            "animations are left out: everything is as at rest; --time SECONDS shows a moment",
        )
        return Poses(container)
    if len(animations) > 1:
        findings.note(container.shown, f"of {len(animations)} animations the first is shown")
    animation = container.item("animations", 0, "the file")
    found: dict[tuple[int, str], list[float]] = {}
    for number, channel in enumerate(value(animation, "channels", [])):
        place = f"animations[0].channels[{number}]"
        target = value(channel, "target", {})
        node, path = value(target, "node", None), value(target, "path", "")
        if path not in _PATHS or not isinstance(node, int):
            findings.lost(
                container.at(place), f'an animated "{str(path)[:40]}" stays as at rest: it is not supported'
            )
            continue
        samplers = value(animation, "samplers", [])
        at = value(channel, "sampler", None)
        if not isinstance(at, int) or not 0 <= at < len(samplers):
            raise InputError.at(container.at(place), "expected an index into its samplers")
        found[node, path] = _sampled(container, samplers[at], path, time, place)
    return Poses(container, found)


def _sampled(container: Container, sampler: Json, path: str, time: float, place: str) -> list[float]:
    """The value of a sampler; before its first key and after its last one those hold."""
    times = container.numbers(value(sampler, "input", None), place, "SCALAR").ravel()
    kind = value(sampler, "interpolation", "LINEAR")
    values = container.numbers(value(sampler, "output", None), place, "SCALAR", "VEC3", "VEC4")
    parts = 3 if kind == "CUBICSPLINE" else 1
    if len(times) == 0 or np.any(np.diff(times) <= 0) or values.size % (len(times) * parts):
        raise InputError.at(container.at(place), "keys increase, and have as many values each")
    keys = values.reshape(len(times), parts, -1)
    if _PATHS[path] and keys.shape[2] != _PATHS[path]:
        raise InputError.at(container.at(place), f'"{path}" has {_PATHS[path]} numbers')
    last = int(np.clip(np.searchsorted(times, time, side="right"), 1, max(1, len(times) - 1)))
    if len(times) == 1 or time <= times[0]:
        found = keys[0, parts // 2]
    elif time >= times[-1]:
        found = keys[-1, parts // 2]
    elif kind == "STEP":
        found = keys[last - 1, 0]
    else:
        step = times[last] - times[last - 1]
        found = _between(keys[last - 1], keys[last], (time - times[last - 1]) / step, step, kind, path)
    if path == "rotation":
        length = float(np.linalg.norm(found))
        if not length > 0:
            raise InputError.at(container.at(place), "a rotation without length")
        found = found / length
    return [float(each) for each in found]


def _between(before: _Array, after: _Array, t: float, step: float, kind: str, path: str) -> _Array:
    """The value at the part t between one key and the next: specification, appendix C."""
    if kind == "CUBICSPLINE":
        # Of each key: the tangent into it, the value, the tangent out of it.
        return np.asarray(
            (2 * t**3 - 3 * t**2 + 1) * before[1]
            + step * (t**3 - 2 * t**2 + t) * before[2]
            + (3 * t**2 - 2 * t**3) * after[1]
            + step * (t**3 - t**2) * after[0]
        )
    first, second = before[0], after[0]
    if path == "rotation":
        # The shorter way round, on the sphere.
        second = second if first @ second >= 0 else -second
        angle = float(np.arccos(np.clip(first @ second, -1.0, 1.0)))
        if angle > 1e-6:
            return np.asarray((np.sin((1 - t) * angle) * first + np.sin(t * angle) * second) / np.sin(angle))
    return np.asarray((1 - t) * first + t * second)
