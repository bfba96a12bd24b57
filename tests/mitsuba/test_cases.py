"""Where Mitsuba's files are easily misread, imported, against its renders: boxes of media, depth, lamps."""

from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

from bench.peer.contenders import frames_of
from tests.mitsuba.renders import Batches
from tests.mitsuba.test_exports import PYTHON

pytestmark = [
    pytest.mark.peers,
    pytest.mark.skipif(not PYTHON.exists(), reason=f"needs Mitsuba in {PYTHON.parents[1]}: `make peers`"),
]

_SAMPLES, _BATCHES = 128, 4
# Of the mean of a channel; and standard errors that are added to it.
_BOUND, _ERRORS = 0.02, 3

SCENE = """<scene version="3.0.0"><default name="spp" value="{samples}"/>
<integrator type="{integrator}"><integer name="max_depth" value="{depth}"/>{hidden}</integrator>
<sensor type="perspective"><float name="fov" value="40"/>
<transform name="to_world"><lookat origin="0,1,5" target="0,0.3,0" up="0,1,0"/></transform>
<film type="hdrfilm"><integer name="width" value="48"/><integer name="height" value="36"/>
<string name="pixel_format" value="xyz"/><rfilter type="box"/></film>
<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/>
<translate y="-1"/></transform><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
{body}</scene>"""
SKY = '<emitter type="constant"><spectrum name="radiance" value="1"/></emitter>'
GLASS = """<shape type="sphere"><float name="radius" value="0.9"/><bsdf type="dielectric"/></shape>
<shape type="sphere"><float name="radius" value="0.5"/><point name="center" x="1.5" y="-0.5" z="0.5"/>
<bsdf type="dielectric"/></shape>"""
MIRROR = """<shape type="rectangle">
<transform name="to_world"><scale value="2"/><translate z="-1.5"/></transform>
<bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>"""
BOX = """<shape type="sphere"><float name="radius" value="1.2"/><bsdf type="null"/>
<medium name="interior" type="heterogeneous"><spectrum name="albedo" value="0.7"/>
<volume name="sigma_t" type="constvolume"><float name="value" value="1.5"/>
<transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/><scale x="1" y="1.6" z="0.8"/></transform>
</volume></medium></shape>"""
LAMPS = {
    "point": '<emitter type="point"><point name="position" x="0.8" y="0.8" z="1"/>'
    '<spectrum name="intensity" value="5"/></emitter>',
    "spot": '<emitter type="spot"><float name="cutoff_angle" value="35"/>'
    '<spectrum name="intensity" value="9"/>'
    '<transform name="to_world"><lookat origin="0.5,2,1" target="0,-1,0" up="0,0,1"/></transform></emitter>',
    "distant": '<emitter type="directional"><vector name="direction" value="-0.4,-1,-0.6"/>'
    '<spectrum name="irradiance" value="2"/></emitter>',
}
PANEL = """<shape type="rectangle">
<transform name="to_world"><rotate x="1" angle="90"/><translate y="1.2"/></transform>
<emitter type="area"><spectrum name="radiance" value="3"/></emitter></shape>"""
HIDDEN = '<boolean name="hide_emitters" value="true"/>'

# name: integrator, depth, whether lights are hidden, content of the scene.
CASES = {
    "medium in a box of its sphere": ("volpath", -1, "", BOX + SKY),
    **{f"glass, depth {depth}": ("volpath", depth, "", GLASS + SKY) for depth in (2, 3, 4, 6)},
    **{f"mirror and glass, depth {depth}": ("path", depth, "", GLASS + MIRROR + SKY) for depth in (3, 5)},
    # Where light comes by a mirror, lamps without a size give none of it there.
    **{f"{name} lamp in view": ("path", 6, "", lamp) for name, lamp in LAMPS.items()},
    "hidden panel in view": ("path", 6, HIDDEN, PANEL),
}


@pytest.mark.parametrize("name", CASES)
def test_as_much_light_as_mitsuba(name: str, tmp_path: Path) -> None:
    integrator, depth, hidden, body = CASES[name]
    scene = tmp_path / "scene.xml"
    scene.write_text(
        SCENE.format(samples=_SAMPLES, integrator=integrator, depth=depth, hidden=hidden, body=body)
    )
    theirs = frames_of(PYTHON, scene, _SAMPLES, _BATCHES, tmp_path).mean(axis=(1, 2))
    imported = import_scene(scene, tmp_path / "ours", ImportOptions())
    ours = Batches(imported, tmp_path / "compiled", _BATCHES, _SAMPLES).means()
    ratio = ours.mean(axis=0) / theirs.mean(axis=0)
    errors = [each.std(axis=0, ddof=1) / each.mean(axis=0) / _BATCHES**0.5 for each in (ours, theirs)]
    error = np.hypot(*errors)
    told = ", ".join(f"{each - 1:+.2%} ± {own:.2%}" for each, own in zip(ratio, error, strict=True))
    print(f"{name}: {told}")  # noqa: T201 - figures for tests/mitsuba/README.md
    assert np.all(np.abs(ratio - 1) <= _BOUND + _ERRORS * error)
