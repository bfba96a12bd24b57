"""The scenes that benches trace, compiled into a folder."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.programs import CHECKOUT

from bench.programs import run

CORNELL = CHECKOUT / "examples" / "cornell" / "scene.json"
BUMPY_SPHERES = CHECKOUT / "examples" / "bumpy_spheres" / "scene.json"

Document = dict[str, Any]


def prepare_meshes() -> None:
    """Makes the meshes of the bumpy spheres where they are missing."""
    if not list(BUMPY_SPHERES.parent.glob("*.ply")):
        run([sys.executable, BUMPY_SPHERES.with_name("make_mesh.py")])


def cornell() -> Document:
    """The Cornell box's document."""
    document: Document = json.loads(CORNELL.read_text())
    return document


def furnace(albedo: float) -> Document:
    """A closed Lambertian box whose walls all emit 1 W m-2 sr-1 nm-1, seen from inside; 0 <= albedo < 1."""
    corner, edge = [-1, -1, -1], 2
    x, y, z = [edge, 0, 0], [0, edge, 0], [0, 0, edge]
    walls = [
        (corner, x, y), ([-1, -1, 1], y, x),
        (corner, y, z), ([1, -1, -1], z, y),
        (corner, z, x), ([-1, 1, -1], x, z),
    ]  # fmt: skip
    return {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0.1, 0.2, 0.3],
            "look_at": [1, 0, 0],
            "up": [0, 1, 0],
            "vertical_field_of_view_degrees": 60,
        },
        "surfaces": [
            {
                "shape": {"type": "quad", "corner": at, "edge_u": u, "edge_v": v},
                "kernel": {"type": "lambertian", "reflectance": albedo},
                "luminaire": {"radiance": {"table": [[300, 1], [900, 1]]}},
            }
            for at, u, v in walls
        ],
    }


def example(name: str, folder: Path) -> Document:
    """A scene of examples/; files that it names are made in `folder`, by the script next to it."""
    place = CHECKOUT / "examples" / name
    folder.mkdir(parents=True, exist_ok=True)
    for script in place.glob("make_*.py"):
        run([sys.executable, script, folder])
    document: Document = json.loads((place / "scene.json").read_text())
    return document


def compile_document(
    document: Document,
    folder: Path,
    edge: int,
    samples: int,
    tracing: Mapping[str, Any],
    sensor: Mapping[str, Any] | None = None,
) -> CompiledFolder:
    """Compiles a square film of `edge` pixels; `tracing` and `sensor` replace options of the document."""
    changed = {
        **document,
        "tracing": {**document.get("tracing", {}), **tracing},
        "sensor": {**document["sensor"], **(sensor or {})},
    }
    return compile_film(changed, folder, edge, edge, samples)


def compile_film(
    document: Document, folder: Path, width: int, height: int, samples: int, into: Path | None = None
) -> CompiledFolder:
    """Compiles the document, into its folder unless told otherwise; files that it names are in `folder`."""
    into = into or folder
    into.mkdir(parents=True, exist_ok=True)
    path = folder / "scene.json"
    path.write_text(json.dumps(document))
    return compile_to(path, into, width, height, samples)
