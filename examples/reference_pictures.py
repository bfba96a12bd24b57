"""Pictures of the scene reference: renders the example of each type that can be seen.

python -m examples.reference_pictures                 # those that are missing
python -m examples.reference_pictures Conductor ...   # these, anyway

The scenes around the examples are here, and the small files that examples name; tests compile all of them.
"""

import argparse
import copy
import json
import math
import struct
import subprocess
import sys
import tempfile
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import trimesh
from nocturne_client.local.programs import need_program
from nocturne_scene.document.reference_examples import Example, examples
from nocturne_scene.meshes.placements import write_placements
from nocturne_scene.photometry import tm25
from numpy.typing import NDArray

FOLDER = Path(__file__).parents[1] / "docs" / "images" / "scene"

MAX_BYTES = 15_000
_EDGE, _SAMPLES = 96, 100

_UNSEEN = {
    *("Wavelengths", "NullKernel", "Polariser", "Retarder", "Measured", "AssetMesh", "Instrument"),
    *("RayFile", "IrradianceMeter", "RadianceMeter", "IntensityMeter", "Meters", "Bands", "Tracing"),
    "YearOfDaylight",
    *(
        "ImportantDirection",
        "MediumBox",
        "Grid",
        "CauchyIndex",
        "TableIndex",
        "ConstantSpectrum",
        "Reradiation",
    ),
    *("HenyeyGreensteinPhase", "DoubleHenyeyGreensteinPhase", "TabulatedPhase", "MiePhase", "Atmosphere"),
    *("Medium", "Droplets", "RayleighPhase", "IsotropicPhase"),
}
"""What a small picture shows nothing of."""

Document = dict[str, Any]

_CAMERA = {
    "type": "pinhole",
    "position": [0, 0.9, 2.6],
    "look_at": [0, 0.45, 0],
    "vertical_field_of_view_degrees": 30,
}
_GREY = {"type": "lambertian", "reflectance": 0.6}
_BALL = {"type": "sphere", "centre": [0, 0.5, 0], "radius": 0.5}
_SHEET = {"type": "quad", "corner": [-0.5, 0.05, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0.9, 0]}


def _strips() -> Document:
    """Dark strips on the floor, so that glass has something to show."""
    corners = [[x, 0.001, z] for left in np.arange(-2, 2, 0.5) for x in (left, left + 0.25) for z in (-2, 2)]
    faces = [[n, n + 1, n + 2] for n in range(0, 32, 4)] + [[n + 2, n + 1, n + 3] for n in range(0, 32, 4)]
    vertices = [[float(x), float(y), float(z)] for x, y, z in corners]
    return {
        "shape": {"type": "mesh", "vertices": vertices, "triangles": faces},
        "kernel": {"type": "lambertian", "reflectance": 0.15},
    }


def _stage() -> Document:
    """A striped floor, a wall behind, a lamp above on the left, and dim light from everywhere."""
    return {
        "nocturne": 1,
        "sensor": _CAMERA,
        "environment": {"radiance": {"illuminant": "D65", "luminance": 150}},
        "surfaces": [
            {
                "shape": {"type": "quad", "corner": [-2, 0, 2], "edge_u": [4, 0, 0], "edge_v": [0, 0, -4]},
                "kernel": _GREY,
            },
            _strips(),
            {
                "name": "wall",
                "shape": {"type": "quad", "corner": [-2, 0, -2], "edge_u": [4, 0, 0], "edge_v": [0, 3, 0]},
                "kernel": {"type": "lambertian", "reflectance": 0.4},
            },
            {
                "shape": {"type": "sphere", "centre": [-1.2, 2.2, 1.2], "radius": 0.3},
                "kernel": {"type": "lambertian", "reflectance": 0.1},
                "luminaire": {"radiance": {"illuminant": "D65", "luminance": 8000}},
            },
        ],
    }


def scene_of(name: str, example: Example) -> Document:
    """A scene document that holds the example of a type."""
    scene, value = _stage(), json.loads(example.text)
    match example.at:
        case "kernel":
            scene["surfaces"].append({"shape": _BALL, "kernel": value})
        case "sheet":
            scene["surfaces"].append({"shape": _SHEET, "kernel": value})
            scene["surfaces"].append(
                {"shape": {**_BALL, "centre": [0.3, 0.3, -0.8], "radius": 0.3}, "kernel": _GREY}
            )
        case "surface":
            scene["surfaces"].append(value)
            if "luminaire" in value:
                del scene["surfaces"][3]
                scene["environment"]["radiance"]["luminance"] = 10
                scene["surfaces"].append(
                    {"shape": {**_BALL, "centre": [0, 0.3, 0], "radius": 0.3}, "kernel": _GREY}
                )
        case "shape":
            scene["surfaces"].append({"shape": value, "kernel": {"type": "lambertian", "reflectance": 0.7}})
        case "spectrum":
            scene["surfaces"].append({"shape": _BALL, "kernel": {"type": "lambertian", "reflectance": value}})
        case "radiance":
            del scene["surfaces"][3]
            scene["environment"]["radiance"]["luminance"] = 10
            scene["surfaces"].append(
                {"shape": _BALL, "kernel": {"type": "null"}, "luminaire": {"radiance": value}}
            )
        case "medium" | "phase":
            medium = value if example.at == "medium" else {"scattering": 8, "phase": value}
            scene["media"] = {"stuff": medium}
            box = {"type": "box", "minimum": [-0.5, 0.002, -0.5], "maximum": [0.5, 1, 0.5]}
            scene["surfaces"].append({"shape": box, "interior": {"media": ["stuff"]}})
        case "environment":
            del scene["surfaces"][2:]
            scene["environment"] = value
            scene["surfaces"].append({"shape": _BALL, "kernel": {"type": "conductor", "index": "Ag"}})
        case "sensor" | "tracing":
            scene[example.at] = value
            scene["surfaces"].append({"shape": _BALL, "kernel": _GREY})
        case "whole":
            _merge(scene, copy.deepcopy(value), name)
    return scene


def _merge(scene: Document, value: Document, name: str) -> None:
    """Adds parts of the top level."""
    if name in {"DistantDisc", "Atmosphere"}:
        del scene["surfaces"][2:], scene["environment"]
        scene["surfaces"].append({"shape": _BALL, "kernel": _GREY})
    if name in {"RayFile", "IntensityMeter"}:
        del scene["surfaces"][0 if name == "IntensityMeter" else 1 :], scene["environment"]
    if name == "Medium":
        # As large as a drop: the camera comes near.
        scene["sensor"] = {**_CAMERA, "position": [0, 0.018, 0.052], "look_at": [0, 0.009, 0]}
    surfaces = value.pop("surfaces", [])
    scene["surfaces"] += surfaces
    scene.update(value)


def write_files(folder: Path) -> None:
    """The files that examples name."""
    cells = np.indices((8, 8)).sum(axis=0) % 2
    checks = np.where(cells[..., None] == 1, [0.85, 0.8, 0.7], [0.2, 0.35, 0.2])
    _image(folder / "checks.png", checks)
    rows, columns = np.mgrid[0:64, 0:64] / 64 * 2 * np.pi
    _image(folder / "bumps.png", (0.5 + 0.25 * (np.sin(3 * rows) + np.sin(3 * columns)))[..., None])
    normals = np.stack([0.3 * np.cos(4 * columns), 0.3 * np.sin(4 * rows), np.ones_like(rows)], axis=-1)
    _image(folder / "normals.png", 0.5 + 0.5 * normals / np.linalg.norm(normals, axis=-1, keepdims=True))
    up = np.linspace(1, -1, 16)[:, None, None]
    sky = np.where(up > 0, [0.3, 0.5, 0.9] + 0.6 * (1 - up), [0.15, 0.12, 0.1]) * np.ones((16, 32, 3))
    sky[3:5, 8:10] += 20
    _image(folder / "sky.exr", sky)
    head = struct.pack("<8sIIIIIIff", b"NOCTBRDF", 1, 4, 4, 6, 1, 0, 550.0, 100.0)
    lobe = 0.15 + 0.4 * np.exp(-2.0 * np.arange(4))[:, None, None] * np.ones((4, 4, 6))
    (folder / "paint.table").write_bytes(head + lobe.astype("<f4").tobytes())
    (folder / "spot.ies").write_text(_IES)
    (folder / "knot.ply").write_bytes(trimesh.creation.torus(0.35, 0.12).export(file_type="ply"))
    places = np.zeros((8, 8))
    places[:, 0] = 0.8 * np.cos(np.arange(8) * np.pi / 4)
    places[:, 2] = 0.8 * np.sin(np.arange(8) * np.pi / 4)
    places[:, 3], places[:, 5] = 1.0, 1.0
    write_placements(folder / "places.ply", places)
    _rays(folder / "led.tm25ray")
    (folder / "year.epw").write_text(_weather())
    _grids(folder)


_IES = """IESNA:LM-63-2002
TILT=NONE
1 -1 1 5 1 1 2 0.2 0.2 0
1 1 10
0 15 30 45 90
0
900 700 150 20 0
"""


def _weather() -> str:
    """A year at 48.8 degrees north in which each day is alike."""
    header = ["LOCATION,Somewhere,-,-,none,0,48.8,9.2,1.0,250", *["-"] * 7]
    rows = []
    for hour in range(8760):
        when = datetime(2001, 1, 1, tzinfo=UTC) + timedelta(hours=hour)
        up = max(0.0, math.sin(math.pi * (when.hour - 7.5) / 9))
        day = [when.year, when.month, when.day, when.hour + 1]
        rows.append(",".join(map(str, [*day, 0, "-", 10, 5, 50, 1e5, 0, 0, 300, 0, 500 * up, 200 * up])))
    return "\n".join([*header, *rows]) + "\n"


def _image(path: Path, pixels: NDArray[np.float64]) -> None:
    spec = oiio.ImageSpec(
        pixels.shape[1], pixels.shape[0], pixels.shape[2], "float" if path.suffix == ".exr" else "uint8"
    )
    buffer = oiio.ImageBuf(spec)
    buffer.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels, dtype=np.float32))
    if not buffer.write(str(path)):
        raise OSError(f"{path}: {buffer.geterror()}")


def _rays(path: Path) -> None:
    """200 rays by the cosine, along +z, from a square of 1 cm; 1000 lm."""
    chance = np.random.default_rng(5)
    sine, around = np.sqrt(chance.random(200)), 2 * np.pi * chance.random(200)
    directions = np.stack([sine * np.cos(around), sine * np.sin(around), np.sqrt(1 - sine**2)], axis=1)
    starts = np.append(chance.uniform(-0.005, 0.005, (200, 2)), np.zeros((200, 1)), axis=1)
    light = np.array([400.0, 550.0, 700.0]), np.array([0.25, 1.0, 0.5])
    lumens = np.full(200, 5.0, dtype=np.float32)
    rays = tm25.RayFile(
        starts.astype(np.float32), directions.astype(np.float32), watts=None, lumens=lumens, spectra=[light]
    )
    tm25.write(path, rays)


def _grids(folder: Path) -> None:
    """A ball of smoke that is hot in its middle."""
    middle = (np.indices((9, 9, 9)) - 4) / 4
    radius = np.sqrt((middle**2).sum(axis=0))
    grids = {"density": np.clip(1 - radius, 0, 1), "temperature": 2200 - 800 * radius}
    for name, values in grids.items():
        (folder / f"{name}.raw").write_bytes(values.astype("<f4").tobytes())
    files = [{"name": name, "file": f"{name}.raw"} for name in grids]
    told = {"dims": [9, 9, 9], "voxel_size": 0.1, "origin": [-0.45, 0.05, -0.45], "grids": files}
    (folder / "grids.json").write_text(json.dumps(told))
    files_in: list[str | Path] = ["create", folder / "grids.json", "-o", folder / "smoke.vdb"]
    command: list[str | Path] = [need_program("nocturne-grid"), *files_in]
    subprocess.run(command, check=True, capture_output=True)  # noqa: S603


def shown() -> list[str]:
    """Types that have a picture."""
    return [name for name in examples() if name not in _UNSEEN]


def picture_of(name: str) -> Path:
    """Where a type's picture is."""
    return FOLDER / f"{name.lower()}.webp"


def main() -> None:
    """Render missing pictures, or those of the named types."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("types", nargs="*", help="names of types; default: those without a picture")
    named = parser.parse_args().types
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="nocturne-reference-") as place:
        folder = Path(place)
        write_files(folder)
        for name in named or [each for each in shown() if not picture_of(each).exists()]:
            render(name, folder)
            print(name, f"{picture_of(name).stat().st_size} bytes", flush=True)


def render(name: str, folder: Path) -> None:
    """One picture."""
    scene = folder / f"{name}.json"
    scene.write_text(json.dumps(scene_of(name, examples()[name])))
    width = 2 * _EDGE if name == "Panorama" else _EDGE
    size = ["--width", str(width), "--height", str(_EDGE), "--samples", str(_SAMPLES)]
    output = folder / f"{name}.png"
    command: list[str | Path] = [
        sys.executable,
        "-m",
        "nocturne_client",
        "render",
        scene,
        "-o",
        output,
        *size,
    ]
    subprocess.run(command, check=True, capture_output=True)  # noqa: S603
    buffer = oiio.ImageBuf(str(output))
    for quality in (90, 80, 70, 60, 50):
        buffer.specmod().attribute("compression", f"webp:{quality}")
        buffer.write(str(picture_of(name)))
        if picture_of(name).stat().st_size <= MAX_BYTES:
            return
    raise ValueError(f"{name}: more than {MAX_BYTES} bytes")


if __name__ == "__main__":
    main()
