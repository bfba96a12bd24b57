"""A scene around a part of it in Mitsuba's words, imported."""

import json
from pathlib import Path
from typing import Any

from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import Imported, ImportOptions

SENSOR = """
<sensor type="perspective">
  <float name="fov" value="45"/>
  <transform name="to_world"><lookat origin="0 0 -5" target="0 0 0" up="0 1 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="20"/></film>
  <sampler type="independent"><integer name="sample_count" value="7"/></sampler>
</sensor>
"""
SPHERE = '<shape type="sphere"/>'


def imported(tmp_path: Path, body: str, **options: Any) -> tuple[dict[str, Any], Imported]:
    folder = tmp_path / "in"
    folder.mkdir(parents=True, exist_ok=True)
    lit = any(f'type="{kind}"' in body for kind in ("constant", "envmap"))
    light = "" if lit else '<emitter type="constant"/>'
    (folder / "a.xml").write_text(f'<scene version="3.0.0">{SENSOR}{body}{light}</scene>')
    found = import_scene(folder / "a.xml", tmp_path / "out", ImportOptions(**options))
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document, found


def kernel(tmp_path: Path, bsdf: str, **options: Any) -> Any:
    document, _ = imported(tmp_path, f'<shape type="sphere">{bsdf}</shape>', **options)
    return document["surfaces"][0]["kernel"]
