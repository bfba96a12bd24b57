"""What all plugin functions work with."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.elements import Element
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.mitsuba.read.tree import SceneTree
from nocturne_scene.formats.reading.crowds import Crowds
from nocturne_scene.formats.reading.extent import Extent
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.lamps import Lamps
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.meshes.triangles import Triangles


@dataclass(frozen=True)
class Bsdf:
    """A kernel, and what changes the surface's shading normal (fields of a surface)."""

    kernel: Json
    normal_or_bump: dict[str, Any] = field(default_factory=dict)


@dataclass
class Context:
    """One import in progress."""

    tree: SceneTree
    writer: SceneWriter
    findings: Findings
    options: ImportOptions
    textures: dict[int, Json] = field(default_factory=dict)
    """Textures made so far, by the number of their element."""
    bsdfs: dict[str, str] = field(default_factory=dict)
    """Names of kernels made so far, by id."""
    materials: dict[int, Bsdf] = field(default_factory=dict)
    """Materials made so far, by the number of their element."""
    media: dict[int, list[str]] = field(default_factory=dict)
    """Names of media made so far, by the number of their element; empty where there is nothing."""
    enclosed: set[str] = field(default_factory=set)
    """Names of media that are inside of a shape."""
    meshes: dict[tuple[Path, str], Triangles] = field(default_factory=dict)
    """Mesh files read so far."""
    groups: dict[str, str] = field(default_factory=dict)
    """Groups made so far, by the id of their shapegroup; empty where nothing is in it."""
    hides_emitters: bool = False
    """Whether the camera sees past all lights."""
    extent: Extent = field(default_factory=Extent)
    crowds: Crowds = field(init=False)
    """Shapes and instances of the scene."""
    lamps: Lamps = field(init=False)
    """Lamps without a size."""

    def __post_init__(self) -> None:
        self.crowds = Crowds(self.writer, self.findings)
        self.lamps = Lamps(self.writer, self.findings, self.options, self.extent)

    def properties(self, element: Element) -> Properties:
        """The parameters of a plugin."""
        return Properties(element, self.tree, self.findings)

    def file(self, properties: Properties, what: str = "") -> Path:
        """Return the file that a plugin needs. Raises InputError."""
        name = properties.text("filename", None)
        if name is None:
            raise InputError.at(
                properties.place, f'{what or f"a {properties.element.type}"} needs "filename"'
            )
        return self.tree.file(properties.element, name)
