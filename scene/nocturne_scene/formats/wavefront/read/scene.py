"""A whole OBJ file: faces by material."""

from array import array
from itertools import pairwise
from pathlib import Path

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.extent import Extent
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_files import SceneFiles
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.formats.reading.views import panorama_inside
from nocturne_scene.formats.wavefront.read.materials import GREY, materials_of
from nocturne_scene.meshes.triangles import Triangles
from nocturne_scene.texts import text_of

_MOST = 20_000_000
"""Vertices, and triangles."""
_LEFT_OUT = {
    "l": "lines have no surface",
    "p": "points have no surface",
    "curv": "curves are not read",
    "surf": "free-form surfaces are not read",
}


class _Faces:
    """Vertices of a file, and triangles by material."""

    def __init__(self) -> None:
        self.vertices = array("d")
        self.triangles: dict[str, array[int]] = {}
        self.material = ""

    def vertex(self, words: list[str], place: str) -> None:
        """A line that begins with v."""
        try:
            self.vertices.extend(float(word) for word in words[1:4])
        except ValueError:
            raise InputError.at(place, "expected three numbers") from None
        if len(words) < 4 or len(self.vertices) > 3 * _MOST:
            raise InputError.at(place, f"expected three numbers, and at most {_MOST:,} vertices")

    def face(self, words: list[str], place: str) -> None:
        """A line that begins with f: a polygon as a fan of triangles."""
        count = len(self.vertices) // 3
        corners = []
        for word in words[1:]:
            try:
                index = int(word.partition("/")[0])
            except ValueError:
                raise InputError.at(place, f"expected numbers of vertices, found {word[:40]!r}") from None
            index = index - 1 if index > 0 else count + index
            if not 0 <= index < count:
                raise InputError.at(place, f"there is no vertex {word[:40]}; {count} stand before this line")
            corners.append(index)
        if len(corners) < 3:
            raise InputError.at(place, "expected three corners or more")
        kept = self.triangles.setdefault(self.material, array("q"))
        for second, third in pairwise(corners[1:]):
            kept.extend((corners[0], second, third))
        if len(kept) > 3 * _MOST:
            raise InputError.at(place, f"more than {_MOST:,} triangles")


def import_obj(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    """Writes the scene of an OBJ file. Raises InputError with the line."""
    files = SceneFiles(options.root or file.parent)
    faces, known = _Faces(), dict[str, tuple[Json, Json]]()
    with file.open("rb") as binary, text_of(binary) as lines:
        for number, line in enumerate(lines, start=1):
            words = line.partition("#")[0].split()
            place = f"{file.name}, line {number}"
            match words[:1]:
                case ["v"]:
                    faces.vertex(words, place)
                case ["f"]:
                    faces.face(words, place)
                case ["usemtl"]:
                    faces.material = " ".join(words[1:])
                case ["mtllib"]:
                    with findings.leaving_out():
                        found = files.find(line.split(None, 1)[1].strip(), [file.parent], place)
                        for name, kernel, radiance in materials_of(found, findings):
                            known[name] = kernel, radiance
                case [word] if word in _LEFT_OUT:
                    findings.lost(place, _LEFT_OUT[word])
                case _:
                    # Normals, coordinates, groups and names change nothing here.
                    pass
    if not faces.triangles:
        raise InputError.at(file.name, "has no faces")
    _write(faces, known, writer, findings, file.name)


def _write(
    faces: _Faces,
    known: dict[str, tuple[Json, Json]],
    writer: SceneWriter,
    findings: Findings,
    shown: str,
) -> None:
    vertices, extent = np.array(faces.vertices).reshape(-1, 3), Extent()
    for material, indices in faces.triangles.items():
        if material not in known:
            findings.note(shown, f"material {material or 'of faces without one'} is not there: grey of 0.5")
        kernel, radiance = known.get(material, (GREY, None))
        used, numbers = np.unique(np.array(indices), return_inverse=True)
        mesh = Triangles(vertices[used], numbers.reshape(-1, 3))
        extent.add(mesh.vertices)
        name = material or "surface"
        kernel_name = writer.name("kernels", name, kernel)
        lit = {} if radiance is None else {"luminaire": {"radiance": radiance}}
        shape = writer.mesh(name, mesh)
        writer.add("surfaces", {"name": name[:60], "shape": shape, "kernel": kernel_name, **lit})
    writer.document["sensor"] = panorama_inside(extent, findings)
    findings.note("", "lengths are taken as metres and y as up; faces are flat, whatever their normals")
