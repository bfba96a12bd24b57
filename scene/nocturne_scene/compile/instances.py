"""Groups of surfaces, and instances of groups in groups flattened to one level."""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile.placement import placement_of, placements_of
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.luminaires import PhotometricProfile
from nocturne_scene.document.placement import Rotation
from nocturne_scene.document.problems import path
from nocturne_scene.document.surfaces import Instance, Surface
from nocturne_scene.errors import Problem
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.placements import Numbers, Placements
from nocturne_scene.meshes.similarity import IDENTITY, Similarity

_Steps = list[Similarity]
# Placements of a file that are flattened together.
_AT_ONCE = 10_000


class Instances:
    """Numbers the groups that are used, and flattens what shows them."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._groups = workspace.document.groups
        self._numbers: dict[str, int] = {}
        self._flattened_count = lru_cache(maxsize=None)(self._count)
        self._placed: dict[int, _Steps] = {}
        for name in self._reached():
            workspace.use("groups", name)
            if any(_is_shared(member) for member in self._groups[name]):
                self._numbers[name] = len(self._numbers) + 1

    def surfaces(self) -> Iterator[tuple[Surface, int, str]]:
        """Yield the surfaces of all groups that are used, with the group's number and the surface's place."""
        for name, number in self._numbers.items():
            for index, member in enumerate(self._groups[name]):
                if isinstance(member, Surface) and _is_shared(member):
                    yield member, number, path(("groups", name, index))

    def lamps(self) -> Iterator[tuple[Surface, str]]:
        """Yield the surfaces of groups whose light is that of one lamp, once for each place where an instance
        shows them, with their places in the document."""
        if not any(_is_lamp(member) for name in self._reached() for member in self._groups[name]):
            return
        for index, instance in enumerate(self._workspace.document.instances):
            yield from self._lamps_shown(instance, [IDENTITY], path(("instances", index)))

    def flattened(self) -> Iterator[scene_pb2.Instance]:
        """Yield all instances; notes a problem instead if there are too many."""
        top = self._workspace.document.instances
        total = sum(self._copies(instance) * self._flattened_count(instance.group) for instance in top)
        if total > bounds.FLATTENED_INSTANCES:
            self._workspace.problems.append(
                Problem(
                    "$.instances",
                    f"{total} instances once groups in groups are flattened; "
                    f"at most {bounds.FLATTENED_INSTANCES}",
                )
            )
            return
        for index, instance in enumerate(top):
            yield from self._shown(instance, [self._workspace.frame], path(("instances", index)))

    def _reached(self) -> list[str]:
        """Names of groups that are used, in the order of the document's instances; cycles were refused."""
        found: dict[str, None] = {}
        waiting = [instance.group for instance in reversed(self._workspace.document.instances)]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found[name] = None
                members = reversed(self._groups[name])
                waiting.extend(member.group for member in members if isinstance(member, Instance))
        return list(found)

    def _count(self, name: str) -> int:
        inner = (member for member in self._groups[name] if isinstance(member, Instance))
        copies = (self._copies(instance) * self._flattened_count(instance.group) for instance in inner)
        return (name in self._numbers) + sum(copies)

    def _copies(self, instance: Instance) -> int:
        """Copies of the group; a file that can't be read is reported where it is used."""
        if instance.placements is None:
            return 1
        try:
            return self._workspace.count_placements(instance.placements.asset)
        except (Unusable, UnusableMeshError):
            return 1

    def _placements(self, instance: Instance) -> _Steps:
        """Those of a part of the document, which lives as long as this: computed once, shown often."""
        if id(instance) not in self._placed:
            self._placed[id(instance)] = placements_of(instance)
        return self._placed[id(instance)]

    def _shown(self, instance: Instance, around: _Steps, place: str) -> Iterator[scene_pb2.Instance]:
        with self._workspace.problems_at(place):
            own = self._placements(instance)
            self._workspace.report_motion(instance.motion, len(own), place)
            steps = _combined(around, own)
            if instance.placements is None:
                yield from self._at(instance.group, steps)
            else:
                yield from self._from_file(instance.group, steps, self._file(instance.placements.asset))

    def _lamps_shown(self, instance: Instance, around: _Steps, place: str) -> Iterator[tuple[Surface, str]]:
        with self._workspace.problems_at(place):
            steps = _combined(around, self._placements(instance))
            placed = None if instance.placements is None else self._file(instance.placements.asset)
            for inner in [steps] if placed is None else _each(steps, placed):
                yield from self._lamps_of(instance.group, inner)

    def _lamps_of(self, name: str, steps: _Steps) -> Iterator[tuple[Surface, str]]:
        for index, member in enumerate(self._groups[name]):
            place = path(("groups", name, index))
            if isinstance(member, Instance):
                yield from self._lamps_shown(member, steps, place)
            elif _is_lamp(member):
                if len(steps) > 1 or member.motion is not None:
                    raise Unusable(
                        "moves, and shows a lamp with a photometric file, lumens or watts; expected one at "
                        "rest, or a radiance"
                    )
                yield _placed(member, steps[0]), place

    def _file(self, asset: str) -> Placements:
        try:
            return self._workspace.placements(asset)
        except (Unusable, UnusableMeshError) as error:
            raise Unusable(str(error), ".placements.asset") from None

    def _at(self, name: str, steps: _Steps) -> Iterator[scene_pb2.Instance]:
        if name in self._numbers:
            rows = np.stack([step.rows() for step in steps])
            yield _message(self._numbers[name], rows)
        yield from self._inside(name, steps)

    def _inside(self, name: str, steps: _Steps) -> Iterator[scene_pb2.Instance]:
        for index, member in enumerate(self._groups[name]):
            if isinstance(member, Instance):
                yield from self._shown(member, steps, path(("groups", name, index)))

    def _from_file(self, name: str, around: _Steps, placed: Placements) -> Iterator[scene_pb2.Instance]:
        has_inner = any(isinstance(member, Instance) for member in self._groups[name])
        for first in range(0, len(placed), _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            scales, rotations, shifts = placed.scales[part], placed.rotations[part], placed.shifts[part]
            if name in self._numbers:
                linear = scales[:, None, None] * rotations
                rows = np.stack([_rows(step, linear, shifts) for step in around], axis=1)
                yield from (_message(self._numbers[name], each) for each in rows)
            if has_inner:
                for scale, rotation, shift in zip(scales, rotations, shifts, strict=True):
                    own = Similarity(float(scale), rotation, shift)
                    yield from self._inside(name, [step.after(own) for step in around])


def _is_lamp(member: Surface | Instance) -> bool:
    """Whether its light is that of one surface of a certain size and direction: instances show it as
    separate surfaces, so that each of them emits it."""
    if not isinstance(member, Surface) or member.luminaire is None:
        return False
    light = member.luminaire
    return (
        isinstance(light.profile, PhotometricProfile) or light.lumens is not None or light.watts is not None
    )


def _is_shared(member: Surface | Instance) -> bool:
    return isinstance(member, Surface) and not _is_lamp(member)


def _each(around: _Steps, placed: Placements) -> Iterator[_Steps]:
    for scale, rotation, shift in zip(placed.scales, placed.rotations, placed.shifts, strict=True):
        own = Similarity(float(scale), rotation, shift)
        yield [step.after(own) for step in around]


def _placed(surface: Surface, at: Similarity) -> Surface:
    """The same where an instance shows it."""
    # So that scenes without lamps in groups do without it.
    from scipy.spatial.transform import Rotation as Turns

    whole = at.after(placement_of(surface))
    turn = Turns.from_matrix(whole.rotation).as_rotvec(degrees=True)
    degrees = float(np.linalg.norm(turn))
    rotate = Rotation(axis=tuple(turn / degrees), degrees=degrees) if degrees > 0 else None
    update = {"scale": whole.scale, "rotate": rotate, "translate": tuple(whole.shift.tolist())}
    return surface.model_copy(update=update)


def _combined(outer: _Steps, inner: _Steps) -> _Steps:
    if len(outer) > 1 and len(inner) > 1:
        raise Unusable("moves inside of an instance that moves; only one of them may", ".motion")
    return [placed.after(own) for placed in outer for own in inner]


def _rows(step: Similarity, linear: Numbers, shifts: Numbers) -> Numbers:
    """The 3 x 4 matrices of copies that are placed once more, shape (n, 3, 4)."""
    placed = np.concatenate([linear, shifts[:, :, None]], axis=2)
    rows = step.scale * step.rotation @ placed
    rows[:, :, 3] += step.shift
    return np.asarray(rows)


def _message(group: int, rows: Numbers) -> scene_pb2.Instance:
    """`rows` of all steps, shape (steps, 3, 4)."""
    if not abs(rows).max() <= bounds.LENGTH:
        raise Unusable(f"is farther than {bounds.LENGTH:g} m from the origin, or larger than that")
    return scene_pb2.Instance(group=group, transforms=(rows + 0.0).ravel().tolist())
