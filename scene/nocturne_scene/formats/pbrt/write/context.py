"""What all functions of the export to pbrt work with."""

from dataclasses import dataclass, field

from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import SceneWriter
from nocturne_scene.formats.writing.compiled import Compiled


@dataclass
class Context:
    """One export in progress."""

    compiled: Compiled
    writer: SceneWriter
    findings: Findings
    head: list[str] = field(default_factory=list)
    """Lines before the world begins: media, and how the image is made."""
    world: list[str] = field(default_factory=list)
    media: dict[str, str] = field(default_factory=dict)
    """Names of media by their description."""
    materials: dict[tuple[int, int], str] = field(default_factory=dict)
    """Names of materials by kernel and interior; empty for an interface."""
    textures: list[str] = field(default_factory=list)
    """Names of textures."""
