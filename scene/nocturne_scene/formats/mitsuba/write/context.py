"""What all functions of the export to Mitsuba work with."""

from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

import numpy as np

from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import SceneWriter
from nocturne_scene.formats.writing.compiled import Compiled
from nocturne_scene.formats.writing.tables import Array


@dataclass
class Context:
    """One export in progress."""

    compiled: Compiled
    writer: SceneWriter
    findings: Findings
    root: Element
    media: dict[str, str] = field(default_factory=dict)
    """Ids of media by their description."""
    bsdfs: dict[tuple[int, ...], str] = field(default_factory=dict)
    """Ids of materials by their kernels and interior."""

    def picture(self, name: str, pixels: Array) -> str:
        """Write a picture, shape (height, width, 1 or 3), and return its name."""
        return self.writer.picture(name, np.asarray(pixels))
