"""Spheres of Mitsuba's principled material, imported, against its renders: how much light they send back."""

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

_SAMPLES = 1024

SCENE = """<scene version="3.0.0"><default name="spp" value="{samples}"/>
<integrator type="path"><integer name="max_depth" value="8"/>
<boolean name="hide_emitters" value="true"/></integrator>
<sensor type="perspective"><float name="fov" value="30"/>
<transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
<film type="hdrfilm"><integer name="width" value="48"/><integer name="height" value="48"/>
<string name="pixel_format" value="xyz"/><rfilter type="box"/></film>
<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>
{light}<shape type="sphere"><float name="radius" value="0.8"/>
<bsdf type="principled"><rgb name="base_color" value="0.6,0.4,0.2"/>{numbers}</bsdf></shape></scene>"""
SKY = '<emitter type="constant"><rgb name="radiance" value="1"/></emitter>'
LAMP = (
    '<emitter type="directional"><vector name="direction" value="-1,-1,-1"/>'
    '<rgb name="irradiance" value="3"/></emitter>'
)

MATERIALS: dict[str, dict[str, float]] = {
    "plain": {},
    "smooth": {"roughness": 0.1},
    "rough": {"roughness": 1},
    "flat": {"flatness": 1},
    "coated": {"clearcoat": 1, "clearcoat_gloss": 0.8},
    "sheen": {"sheen": 1},
    "tinted": {"sheen": 1, "sheen_tint": 1, "spec_tint": 1, "specular": 1},
    "brushed": {"anisotropic": 0.8},
    "half metal": {"metallic": 0.5},
}
# Mitsuba's spectral variants divide a tint by the luminance of the few wavelengths of a path: 10 to 25 % more
# comes back than by its variants in RGB.
IN_RGB = ("tinted",)
# Under a lamp both reflect as much only if their lobes have the same shapes. Flat lobes, fuzz and the tails
# of coats do not, and the base of a partly metallic surface has the colour of the metal, too.
CASES = [(name, SKY) for name in MATERIALS] + [
    (name, LAMP) for name in ("plain", "smooth", "rough", "brushed")
]


@pytest.mark.parametrize(
    ("name", "light"), CASES, ids=[f"{n} {'sky' if e == SKY else 'lamp'}" for n, e in CASES]
)
def test_a_sphere_sends_back_as_much_light(name: str, light: str, tmp_path: Path) -> None:
    parameters = MATERIALS[name]
    numbers = "".join(f'<float name="{each}" value="{value}"/>' for each, value in parameters.items())
    scene = tmp_path / "scene.xml"
    scene.write_text(SCENE.format(samples=_SAMPLES, light=light, numbers=numbers))
    variant = "scalar_rgb" if name in IN_RGB else "scalar_spectral"
    theirs = frames_of(PYTHON, scene, _SAMPLES, 1, tmp_path, variant=variant)[0].mean(axis=(0, 1))
    imported = import_scene(scene, tmp_path / "ours", ImportOptions())
    ours = Batches(imported, tmp_path / "compiled", 2, _SAMPLES // 2).render().mean.mean(axis=(0, 1))
    ratio = ours / theirs
    print(f"{name}: {', '.join(f'{each - 1:+.1%}' for each in ratio)}")  # noqa: T201 - for tests/mitsuba/README.md
    assert ratio == pytest.approx(np.ones(3), abs=0.02)
