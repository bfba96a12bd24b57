"""Photometric files of any kind that is read: IES LM-63 and EULUMDAT, distinguished by their content."""

from nocturne_scene.photometry import eulumdat, ies
from nocturne_scene.photometry.ies import Photometry


def read(data: bytes) -> Photometry:
    """Read a file; raises BadPhotometryError."""
    lines = ies.lines_of(data)
    if not ies.is_lm_63(lines) and eulumdat.is_eulumdat(lines):
        return eulumdat.read(lines)
    return ies.read(data)
