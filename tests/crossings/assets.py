"""The small files that scenes name; made once, the same everywhere."""

import json
import struct
import subprocess
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import trimesh
from nocturne_client.local.programs import need_program
from nocturne_scene.meshes.placements import write_placements
from nocturne_scene.photometry import ies, tm33

TEXTURES = ("grey.png", "colour.png", "colour.exr")
"""Texels lie in 0.2 to 0.9."""
HEIGHTS, NORMALS = "heights.png", "normals.png"
SKY = "sky.exr"
MEASURED = "measured.table"
PROFILES = ("lamp.ies", "type_b.ies", "lamp.xml")
"""Photometric files: type C, type B, and TM-33 with a spectrum."""
GRIDS = "smoke.vdb"
PLACEMENTS = "placements.ply"
MESHES = ("ball.obj", "ball.ply", "ball.stl", "ball.gltf", "ball.glb")
"""Closed, around the origin, within a ball of radius 1."""

VOXELS, VOXEL = 5, 0.15
"""Of the grids, around the origin, m."""
_COUNTS = (4, 4, 6)
"""Of the measured table: theta_h, theta_d, phi_d."""

Values = npt.NDArray[np.float64]


def write(folder: Path) -> None:
    """All of them."""
    random = np.random.default_rng(20261129)
    _image(folder / "grey.png", random.uniform(0.2, 0.9, (5, 4, 1)))
    _image(folder / "colour.png", random.uniform(0.2, 0.9, (4, 6, 3)))
    _image(folder / "colour.exr", random.uniform(0.2, 0.9, (3, 4, 3)))
    _image(folder / HEIGHTS, random.uniform(0.0, 1.0, (6, 6, 1)))
    normals = random.normal(0.0, 0.25, (6, 6, 3)) + np.array([0.0, 0.0, 1.0])
    _image(folder / NORMALS, 0.5 + 0.5 * normals / np.linalg.norm(normals, axis=-1, keepdims=True))
    _sky(folder / SKY, random)
    _measured(folder / MEASURED, random)
    (folder / PROFILES[0]).write_text(_IES)
    (folder / PROFILES[1]).write_text(_TYPE_B)
    lamp = ies.read(_IES.encode())
    light = np.array([400.0, 550.0, 700.0]), np.array([0.4, 1.0, 0.6])
    (folder / PROFILES[2]).write_bytes(tm33.write(replace(lamp, spectrum=light)))
    table = np.zeros((2, 8))
    table[:, :3] = [[-0.65, 0.0, 0.1], [0.65, 0.0, 0.0]]
    table[:, 3] = [0.9, 1.0]
    table[:, 4:] = np.array([[0.0, 1.0, 0.0, 30.0], [0.2, 1.0, 0.0, -75.0]])
    write_placements(folder / PLACEMENTS, table)
    _meshes(folder)
    _grids(folder, random)


def _image(path: Path, pixels: Values) -> None:
    kind = oiio.FLOAT if path.suffix == ".exr" else oiio.UINT8
    height, width, channels = pixels.shape
    output = oiio.ImageOutput.create(str(path))
    assert output is not None
    output.open(str(path), oiio.ImageSpec(width, height, channels, kind))
    output.write_image(pixels.astype(np.float32))
    output.close()


def _sky(path: Path, random: np.random.Generator) -> None:
    """Brighter above, with a wide bright place."""
    rows, columns = 8, 16
    up = np.linspace(1.0, -1.0, rows)[:, None, None]
    pixels = random.uniform(0.3, 1.0, (rows, columns, 3)) * (1.2 + up)
    pixels[1:3, 4:7] += np.array([6.0, 5.0, 4.0])
    _image(path, pixels)


def _measured(path: Path, random: np.random.Generator) -> None:
    """Two planes of a smooth lobe; docs/how-to/measured-brdf.md has the layout."""
    lobe = 0.15 + 0.4 * np.exp(-2.0 * np.arange(_COUNTS[0]))[:, None, None]
    values = lobe * random.uniform(0.8, 1.0, (2, *_COUNTS))
    head = struct.pack("<8sIIIIIIff", b"NOCTBRDF", 1, *_COUNTS, 2, 0, 450.0, 200.0)
    path.write_bytes(head + values.astype("<f4").tobytes())


_TYPE_B = """IESNA:LM-63-2002
TILT=NONE
1 -1 1 3 3 2 2 0.3 0.3 0
1 1 10
-90 0 90
-90 10 90
20 60 30
50 200 80
10 90 20
"""
_IES = """IESNA:LM-63-2002
[MANUFAC] Nobody
TILT=NONE
1 1000 1 5 3 1 2 0.2 0.2 0
1 1 50
0 30 60 90 180
0 90 180
300 250 120 20 5
300 200 100 15 5
300 150 60 30 5
"""


def _meshes(folder: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.95)
    ball.apply_scale([1.0, 0.8, 0.9])
    (folder / MESHES[0]).write_text(_obj(ball.vertices, ball.faces))
    for name in MESHES[1:]:
        made = ball.export(file_type=name.rpartition(".")[2])
        if isinstance(made, dict):
            made = json.dumps(_embedded(made)).encode()
        (folder / name).write_bytes(made if isinstance(made, bytes) else made.encode())


def _obj(vertices: Values, faces: npt.NDArray[np.int64]) -> str:
    """With texture coordinates, which trimesh leaves out without a material."""
    lines = ["v {} {} {}".format(*each) for each in vertices.round(5)]
    lines += [f"vt {0.5 + 0.5 * x:.5f} {0.5 + 0.5 * z:.5f}" for x, _, z in vertices]
    lines += ["f " + " ".join(f"{at}/{at}" for at in face + 1) for face in faces]
    return "\n".join(lines) + "\n"


def _embedded(parts: dict[str, bytes]) -> object:
    """A glTF whose buffers stand in itself."""
    import base64

    document = json.loads(parts["model.gltf"])
    for buffer in document["buffers"]:
        content = base64.b64encode(parts[buffer["uri"]]).decode()
        buffer["uri"] = f"data:application/octet-stream;base64,{content}"
    return document


def _grids(folder: Path, random: np.random.Generator) -> None:
    """Density 0 to 1, sparse, and temperature."""
    shape = (VOXELS, VOXELS, VOXELS)
    density = random.uniform(0.0, 1.0, shape)
    density[density < 0.25] = 0.0
    grids = {"density": density, "temperature": random.uniform(1500.0, 2500.0, shape)}
    for name, values in grids.items():
        (folder / f"{name}.raw").write_bytes(values.astype("<f4").tobytes())
    origin = [-0.5 * VOXELS * VOXEL] * 3
    files = [{"name": name, "file": f"{name}.raw"} for name in grids]
    description = {"dims": shape, "voxel_size": VOXEL, "origin": origin, "grids": files}
    (folder / "grids.json").write_text(json.dumps(description))
    command: Sequence[str | Path] = [need_program("nocturne-grid"), "create", folder / "grids.json"]
    subprocess.run([*command, "-o", folder / GRIDS], check=True, capture_output=True)


@cache
def has_grids() -> bool:
    """The program that makes them is built."""
    from nocturne_client.local.programs import find_program

    return find_program("nocturne-grid") is not None
