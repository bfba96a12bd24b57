"""Lamps of other renderers' scenes light a grey plate as their units say.

The plate has reflectance 1/2 and lies at distance 2 below a point of intensity I: L = I / (2 pi 4); under an
irradiance E: L = E / (2 pi); in an even sky of radiance L': L = L' / 2. False alarms of a case: 6e-5 (four
standard errors).
"""

import json
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT
from nocturne_scene.formats.reading.options import ImportOptions

from tests.accuracy.gltf_plate import gltf
from tests.accuracy.tracing import trace

EDGE, SAMPLES = 8, 256

# The visible patch is half a degree wide: its distance and cosine to the lamp vary by less than a thousandth,
# and spheres and discs in place of points have intensities to 0.1 %.
POINT = 100 / (2 * np.pi * 4)
SUN = 100 / (2 * np.pi)
SKY = 100 / 2

MITSUBA = """<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="0.5"/>
<transform name="to_world"><lookat origin="0, 1, 3" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/></transform>
<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape>{}</scene>"""

PBRT = """LookAt 0 1 3  0 0 0  0 1 0
Camera "perspective" "float fov" 0.5
WorldBegin
{}
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -1 0 1  1 0 1  1 0 -1  -1 0 -1 ] "integer indices" [ 0 1 2  0 2 3 ]
"""


def mitsuba(kind: str, colour: str, place: str = "") -> str:
    """The plate under a lamp; colours are times D65 with a luminance of one unit."""
    rgb = f'<rgb name="{colour}" value="100, 100, 100"/>'
    return MITSUBA.format(f'<emitter type="{kind}">{place}{rgb}</emitter>')


def pbrt(light: str) -> str:
    return PBRT.format(f"LightSource {light}")


CONE = {"innerConeAngle": 0.3, "outerConeAngle": 0.6}
ABOVE = '<point name="position" x="0" y="2" z="0"/>'
DOWNWARDS = '<vector name="direction" x="0" y="-1" z="0"/>'
CASES = {
    "point.xml": (mitsuba("point", "intensity", ABOVE), POINT * CANDELAS_PER_UNIT),
    "sun.xml": (mitsuba("directional", "irradiance", DOWNWARDS), SUN * CANDELAS_PER_UNIT),
    "sky.xml": (mitsuba("constant", "radiance"), SKY * CANDELAS_PER_UNIT),
    "point.pbrt": (pbrt('"point" "point3 from" [ 0 2 0 ] "rgb I" [ 1 1 1 ] "float scale" 100'), POINT),
    # 4 pi 100 lm.
    "bulb.pbrt": (pbrt('"point" "point3 from" [ 0 2 0 ] "rgb I" [ 1 1 1 ] "float power" 1256.637'), POINT),
    "sun.pbrt": (pbrt('"distant" "point3 from" [ 0 1 0 ] "point3 to" [ 0 0 0 ] "float scale" 100'), SUN),
    "sky.pbrt": (pbrt('"infinite" "blackbody L" 5000 "float illuminance" 314.159265'), SKY),
    "point.gltf": (gltf({"type": "point", "intensity": 100}), POINT),
    "spot.gltf": (gltf({"type": "spot", "intensity": 100, "spot": CONE}), POINT),
    "sun.gltf": (gltf({"type": "directional", "intensity": 100}), SUN),
}


@pytest.mark.parametrize("name", CASES)
def test_a_plate_is_as_bright_as_its_light_makes_it(name: str, tmp_path: Path) -> None:
    content, expected = CASES[name]
    (tmp_path / name).write_text(content)
    found = import_scene(tmp_path / name, tmp_path / "out", ImportOptions(light_radius=0.01))
    assert found.missing == []
    image = trace(json.loads(found.document.read_text()), tmp_path / "out", EDGE, SAMPLES)
    error = float(np.sqrt(np.mean(image.y_error**2))) / EDGE
    assert image.y.mean() == pytest.approx(expected, abs=4 * error + 2e-3 * expected)
    assert error < 0.01 * expected
