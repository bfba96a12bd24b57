"""Readings of media by pixels that all measure the same."""

from pathlib import Path

from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.tracing import Document


def read(document: Document, folder: Path, samples: int, edge: int = 8, channel: str = "grey") -> Reading:
    """Mean of edge x edge pixels that all measure the same."""
    folder.mkdir(parents=True, exist_ok=True)
    return Measurement(document, folder, edge, edge).by_pixels(samples, channel)
