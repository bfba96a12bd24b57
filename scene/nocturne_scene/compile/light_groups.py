"""Light groups: lights with further responses of each group, so that they can be dimmed afterwards."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.limits import MAX_FURTHER_RESPONSES
from nocturne_scene.responses import REST, group_channels

UNGROUPED = 0
"""Number of lights without a group."""


class LightGroups:
    """Of a document, numbered from 1 on in the order of their names."""

    def __init__(self, document: SceneDocument) -> None:
        self._document = document

    @cached_property
    def names(self) -> list[str]:
        """Those that lights name."""
        return sorted({name for name in self._named() if name})

    def number(self, name: str) -> int:
        """In the compiled scene."""
        return self.names.index(name) + 1 if name else UNGROUPED

    @property
    def told_apart(self) -> dict[str, int]:
        """Numbers by name, with the rest last if it has light; empty where no light names a group."""
        if not self.names:
            return {}
        numbered = {name: self.number(name) for name in self.names}
        has_rest = "" in self._named() or any(
            getattr(medium, "temperature", None) is not None for medium in self._document.media.values()
        )
        return numbered | ({REST: UNGROUPED} if has_rest else {})

    @property
    def too_many(self) -> str:
        """Why there are too many to separate, in words; empty: there are not."""
        count, most = len(self.told_apart), MAX_FURTHER_RESPONSES // len("XYZ")
        if count <= most:
            return ""
        rest = f', one of them "{REST}" (lights without a name)' if REST in self.told_apart else ""
        return f"{count} light groups{rest}; at most {most}, as each has three further responses"

    def responses(self, observer: NDArray[np.float32]) -> Iterator[scene_pb2.Response]:
        """X, Y and Z of each group."""
        curves = [observer[:, axis].tolist() for axis in range(3)]
        for group, number in self.told_apart.items():
            for name, curve in zip(group_channels(group), curves, strict=True):
                yield scene_pb2.Response(name=name, values=curve, light_group=number)

    def _named(self) -> Iterator[str]:
        """By all lights; "" of those that are in none."""
        document = self._document
        members = (member for group in document.groups.values() for member in group)
        for surface in (*document.surfaces, *members):
            if isinstance(surface, Surface) and surface.luminaire is not None:
                yield surface.luminaire.light_group
        if document.environment is not None:
            yield document.environment.light_group
        yield from (disc.light_group for disc in document.distant)
        yield from (lamp.light_group for lamp in document.ray_files)
