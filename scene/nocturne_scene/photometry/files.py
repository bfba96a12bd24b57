"""Photometric files of any kind that is read, distinguished by their content."""

from nocturne_scene.photometry import eulumdat, ies, tm33
from nocturne_scene.photometry.intensities import Photometry
from nocturne_scene.photometry.xml_tree import MAX_BYTES as MAX_XML_BYTES
from nocturne_scene.photometry.xml_tree import is_xml

MAX_BYTES = MAX_XML_BYTES
"""Of the largest kind of file."""


def read(data: bytes) -> Photometry:
    """Read a file: IES LM-63, EULUMDAT, TM-33 and its kin. Raises BadPhotometryError."""
    if is_xml(data):
        return tm33.read(data)
    lines = ies.lines_of(data)
    if not ies.is_lm_63(lines) and eulumdat.is_eulumdat(lines):
        return eulumdat.read(lines)
    return ies.read(data)
