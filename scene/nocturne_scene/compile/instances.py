"""Groups of surfaces, and instances of groups in groups flattened to one level."""

from collections.abc import Iterator
from functools import lru_cache

from nocturne.v1 import scene_pb2

from nocturne_scene.compile.placement import Similarity, placements_of
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.problems import path
from nocturne_scene.document.surfaces import Instance, Surface
from nocturne_scene.errors import Problem

_Steps = list[Similarity]


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
            if any(isinstance(member, Surface) for member in self._groups[name]):
                self._numbers[name] = len(self._numbers) + 1

    def surfaces(self) -> Iterator[tuple[Surface, int, str]]:
        """Yield the surfaces of all groups that are used, with the group's number and the surface's place."""
        for name, number in self._numbers.items():
            for index, member in enumerate(self._groups[name]):
                if isinstance(member, Surface):
                    yield member, number, path(("groups", name, index))

    def flattened(self) -> Iterator[scene_pb2.Instance]:
        """Yield all instances; notes a problem instead if there are too many."""
        top = self._workspace.document.instances
        total = sum(self._flattened_count(instance.group) for instance in top)
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
        return (name in self._numbers) + sum(self._flattened_count(instance.group) for instance in inner)

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
            name = instance.group
            if name in self._numbers:
                yield _message(self._numbers[name], steps)
            for index, member in enumerate(self._groups[name]):
                if isinstance(member, Instance):
                    yield from self._shown(member, steps, path(("groups", name, index)))


def _combined(outer: _Steps, inner: _Steps) -> _Steps:
    if len(outer) > 1 and len(inner) > 1:
        raise Unusable("moves inside of an instance that moves; only one of them may", ".motion")
    return [placed.after(own) for placed in outer for own in inner]


def _message(group: int, steps: _Steps) -> scene_pb2.Instance:
    message = scene_pb2.Instance(group=group)
    for step in steps:
        rows = step.rows()
        if not abs(rows).max() <= bounds.LENGTH:
            raise Unusable(f"is farther than {bounds.LENGTH:g} m from the origin, or larger than that")
        message.transforms.extend((rows + 0.0).ravel().tolist())
    return message
