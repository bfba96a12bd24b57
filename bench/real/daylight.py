"""Sky and Sun of Mitsuba 0.x as one picture, which both renderers read alike.

Mitsuba 3 has a `sunsky` of the same name with other axes and units.
"""

import json
import math
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import OpenImageIO
from nocturne_client.local.importing import import_to
from nocturne_scene.formats.mitsuba.read.units import white
from nocturne_scene.formats.reading.colours import luminance_of
from nocturne_scene.formats.reading.options import ImportOptions
from numpy.typing import NDArray

KINDS = ("sky", "sun", "sunsky")
_HEIGHT, _WIDTH = 512, 1024
_SHOWN = '<sensor type="perspective"><film type="hdrfilm"/></sensor><shape type="sphere"/>'
_CONSTANT = '<emitter type="constant"/>'


def as_picture(emitter: ET.Element, picture: Path) -> None:
    """Write the picture and let the emitter be one that names it; the zenith is +y."""
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        scene = Path(folder) / "scene.xml"
        around = _SHOWN + (_CONSTANT if emitter.get("type") == "sun" else "")
        scene.write_text(f'<scene version="0.6.0">{around}{ET.tostring(emitter, "unicode")}</scene>')
        found = import_to(scene, Path(folder) / "imported", ImportOptions(allow_missing=True))
        document = json.loads(found.document.read_text())
        values = np.zeros((_HEIGHT, _WIDTH, 3))
        if "asset" in document["environment"]:
            file = found.document.parent / document["environment"]["asset"]
            sky = OpenImageIO.ImageBufAlgo.resize(
                OpenImageIO.ImageBuf(str(file)), roi=OpenImageIO.ROI(0, _WIDTH, 0, _HEIGHT, 0, 1, 0, 3)
            )
            values += sky.get_pixels(OpenImageIO.FLOAT) * document["environment"]["luminance"]
        for sun in document.get("distant", []):
            disc = _disc(sun["direction"], sun["angular_diameter_degrees"])
            values += disc * luminance_of(sun["irradiance"])
    written = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(_WIDTH, _HEIGHT, 3, OpenImageIO.FLOAT))
    written.set_pixels(written.roi, np.asarray(values / white(), dtype=np.float32))
    written.write(str(picture))
    emitter.clear()
    emitter.set("type", "envmap")
    ET.SubElement(emitter, "string", {"name": "filename", "value": picture.name})


def _disc(direction: list[float], degrees: float) -> NDArray[np.float64]:
    """Radiance of unit irradiance in the texels whose middle is in the disc, or in the nearest one."""
    down = ((np.arange(_HEIGHT) + 0.5) * math.pi / _HEIGHT)[:, None]
    around = ((np.arange(_WIDTH) + 0.5) * 2.0 * math.pi / _WIDTH)[None, :]
    x, y, z = np.array(direction) / np.linalg.norm(direction)
    cosine = np.sin(down) * (x * np.sin(around) - z * np.cos(around)) + np.cos(down) * y
    inside = cosine >= min(math.cos(math.radians(degrees / 2.0)), float(cosine.max()))
    solid_angle = inside * np.sin(down) * (math.pi / _HEIGHT) * (2.0 * math.pi / _WIDTH)
    return np.asarray((inside / solid_angle.sum())[..., None], dtype=np.float64)
