"""What all functions of the pbrt importer work with."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.pbrt.read.parameters import Parameter, Parameters
from nocturne_scene.formats.reading.crowds import Crowds
from nocturne_scene.formats.reading.extent import Extent
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.lamps import Lamps
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_files import SceneFiles
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.formats.reading.transforms import IDENTITY, Matrix


@dataclass
class State:
    """The graphics state that `AttributeBegin` saves."""

    transform: Matrix = field(default_factory=lambda: IDENTITY)
    material: Json = field(default_factory=lambda: {"type": "lambertian", "reflectance": 0.5})
    """A kernel, or the name of one."""
    normal_or_bump: Json = field(default_factory=dict)
    area_light: tuple[str, list[Parameter], str] | None = None
    reversed: bool = False
    media: tuple[str, str] = ("", "")
    defaults: dict[str, list[Parameter]] = field(default_factory=dict)


@dataclass
class Context:
    """One import in progress."""

    files: SceneFiles
    folder: Path
    writer: SceneWriter
    findings: Findings
    options: ImportOptions
    state: State = field(default_factory=State)
    outer: Matrix = field(default_factory=lambda: IDENTITY)
    """Mirrors the scene where its camera shows it as a mirror would in a right-handed world."""
    coordinate_systems: dict[str, Matrix] = field(default_factory=dict)
    textures: dict[tuple[str, str], Json] = field(default_factory=dict)
    """By kind and name."""
    materials: dict[str, tuple[str, Json]] = field(default_factory=dict)
    """Kernel's name and normal_or_bump."""
    media: dict[str, list[str]] = field(default_factory=dict)
    """Names in the document by name; empty where there is nothing."""
    enclosed: set[str] = field(default_factory=set)
    """Names in the document of media that are inside of a shape."""
    objects: dict[str, tuple[str, list[Json]]] = field(default_factory=dict)
    """Groups by name: the group's name in the document, and its surfaces."""
    curves: dict[str, list[NDArray[np.float64]]] = field(default_factory=dict)
    """Curves that are no part of objects, by the JSON of what their surface has but a shape."""
    extent: Extent = field(default_factory=Extent)
    crowds: Crowds = field(init=False)
    """Shapes and instances of the scene."""
    lamps: Lamps = field(init=False)
    """Lamps without a size."""
    is_old: bool = False
    """Whether something was met that only pbrt-v3 has."""
    later: list[Callable[[], None]] = field(default_factory=list)
    """What waits for the size of the scene."""

    def __post_init__(self) -> None:
        self.crowds = Crowds(self.writer, self.findings)
        self.lamps = Lamps(self.writer, self.findings, self.options, self.extent)

    def to_world(self) -> Matrix:
        """From the coordinates of now to those of the document."""
        return np.asarray(self.outer @ self.state.transform)

    def parameters(self, what: str, place: str, given: list[Parameter]) -> Parameters:
        """The parameters of a plugin."""
        return Parameters(what, place, given, self.findings)

    def file(self, name: str, place: str) -> Path:
        """A file that the scene names."""
        return self.files.find(name, [self.folder], place)
