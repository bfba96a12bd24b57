"""What all plugin functions work with."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.mitsuba.read.elements import Element, SceneTree
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.meshes.triangles import Triangles


@dataclass
class Context:
    """One import under way."""

    tree: SceneTree
    writer: SceneWriter
    findings: Findings
    options: ImportOptions
    textures: dict[int, Json] = field(default_factory=dict)
    """Textures made so far, by the identity of their element."""
    bsdfs: dict[str, str] = field(default_factory=dict)
    """Names of kernels made so far, by id."""
    media: dict[int, list[str]] = field(default_factory=dict)
    """Names of media made so far, by the identity of their element; empty where there is nothing."""
    enclosed: set[str] = field(default_factory=set)
    """Names of media that are inside of a shape."""
    meshes: dict[tuple[Path, str], Triangles] = field(default_factory=dict)
    """Mesh files read so far."""
    groups: dict[str, str] = field(default_factory=dict)
    """Groups made so far, by the id of their shapegroup."""
    hides_emitters: bool = False
    """Whether the camera sees past all lights."""
    lowest: NDArray[np.float64] = field(default_factory=lambda: np.full(3, np.inf))
    highest: NDArray[np.float64] = field(default_factory=lambda: np.full(3, -np.inf))
    """Box around all surfaces."""

    def properties(self, element: Element) -> Properties:
        """The parameters of a plugin."""
        return Properties(element, self.tree, self.findings)

    def extend(self, points: NDArray[np.float64]) -> None:
        """Let the box hold some points more."""
        self.lowest = np.minimum(self.lowest, points.min(axis=0))
        self.highest = np.maximum(self.highest, points.max(axis=0))

    def light_radius(self) -> float:
        """Of lamps that have none: as given, else a thousandth of the scene's diagonal."""
        if self.options.light_radius is not None:
            return self.options.light_radius
        diagonal = float(np.linalg.norm(self.highest - self.lowest))
        return 1e-3 * diagonal if np.isfinite(diagonal) and diagonal > 0 else 1e-3
