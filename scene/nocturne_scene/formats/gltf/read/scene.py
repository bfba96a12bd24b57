"""A whole scene of glTF: its nodes, and the meshes, cameras and lamps on them."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read.container import Container, Json, floats, number, open_container, value
from nocturne_scene.formats.gltf.read.materials import Materials
from nocturne_scene.formats.reading import colours, lamps, shapes, transforms
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_writer import SceneWriter
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.meshes.headers import UnusableMeshError, check_counts
from nocturne_scene.meshes.triangles import Triangles, check_indices

_KNOWN = (
    "KHR_lights_punctual",
    "KHR_texture_transform",
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_volume",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
)
_MAX_DEPTH = 64
# Nodes visited; a tree has each once.
_MAX_NODES = 100_000


@dataclass
class _Reader:
    container: Container
    writer: SceneWriter
    findings: Findings
    options: ImportOptions
    materials: Materials
    lowest: np.ndarray
    highest: np.ndarray
    lights: list[tuple[int, Matrix]]
    cameras: list[tuple[int, Matrix]]
    visited: int = 0

    def node(self, index: Json, outer: Matrix, above: tuple[Json, ...]) -> None:
        """A node and all below it."""
        self.visited += 1
        if index in above or len(above) >= _MAX_DEPTH or self.visited > _MAX_NODES:
            raise InputError.at(
                self.container.at(f"nodes[{index}]"), "nodes are nested too deep, or in themselves"
            )
        entry = self.container.item("nodes", index, "a scene")
        place = f"nodes[{index}]"
        matrix = outer @ self._matrix(entry, place)
        if "mesh" in entry:
            self._mesh(entry["mesh"], matrix)
        if "camera" in entry:
            self.cameras.append((entry["camera"], matrix))
        if "skin" in entry or "weights" in entry:
            self.findings.lost(self.container.at(place), "no equal of skins and morphing; as at rest")
        light = value(value(value(entry, "extensions", {}), "KHR_lights_punctual", {}), "light", None)
        if light is not None:
            self.lights.append((light, matrix))
        for child in value(entry, "children", []):
            self.node(child, matrix, (*above, index))

    def _matrix(self, entry: Json, place: str) -> Matrix:
        if "matrix" in entry:
            identity = transforms.IDENTITY.ravel().tolist()
            return np.array(floats(self.container, entry, "matrix", identity, place)).reshape(4, 4).T
        x, y, z, w = floats(self.container, entry, "rotation", [0.0, 0.0, 0.0, 1.0], place)
        turn = transforms.IDENTITY
        if math.hypot(x, y, z) > 0:
            turn = transforms.rotation([x, y, z], math.degrees(2 * math.atan2(math.hypot(x, y, z), w)))
        shift = transforms.translation(floats(self.container, entry, "translation", [0.0] * 3, place))
        return np.asarray(
            shift @ turn @ transforms.scaling(floats(self.container, entry, "scale", [1.0] * 3, place))
        )

    def _mesh(self, index: Json, matrix: Matrix) -> None:
        mesh = self.container.item("meshes", index, "a node")
        primitives = value(mesh, "primitives", [])
        for number_, primitive in enumerate(primitives if isinstance(primitives, list) else []):
            place = f"meshes[{index}].primitives[{number_}]"
            name = str(mesh.get("name") or f"mesh-{index}")
            triangles = self._triangles(primitive, place)
            if triangles is None:
                continue
            placed = shapes.transformed(triangles, matrix)
            self.lowest = np.minimum(self.lowest, placed.vertices.min(axis=0))
            self.highest = np.maximum(self.highest, placed.vertices.max(axis=0))
            surface = self.materials.surface(value(primitive, "material", None))
            self.writer.add("surfaces", {"name": name, **surface, "shape": self.writer.mesh(name, placed)})

    def _triangles(self, primitive: Json, place: str) -> Triangles | None:
        shown = self.container.at(place)
        if value(primitive, "mode", 4) != 4:
            self.findings.lost(shown, "no equal of points, lines, strips and fans")
            return None
        if "targets" in primitive or value(primitive, "extensions", {}):
            self.findings.lost(shown, "no equal of morph targets and compressed or varied primitives")
        attributes = value(primitive, "attributes", {})
        points = self.container.numbers(value(attributes, "POSITION", None), place, "VEC3")
        if "COLOR_0" in attributes:
            self.findings.lost(shown, "no equal of colours at vertices")
        normals = coordinates = None
        if "NORMAL" in attributes:
            normals = self.container.numbers(attributes["NORMAL"], place, "VEC3")
        if "TEXCOORD_0" in attributes:
            coordinates = self.container.numbers(attributes["TEXCOORD_0"], place, "VEC2")
            coordinates = np.stack([coordinates[:, 0], 1 - coordinates[:, 1]], 1)
        if "indices" in primitive:
            indices = self.container.numbers(primitive["indices"], place, "SCALAR").astype(np.int64).ravel()
        else:
            indices = np.arange(len(points))
        if any(each is not None and len(each) != len(points) for each in (normals, coordinates)):
            raise InputError.at(shown, "its attributes have different counts")
        if len(points) == 0 or len(indices) % 3:
            raise InputError.at(shown, "has no whole triangles")
        try:
            check_counts(len(points), len(indices) // 3)
            check_indices(len(points), indices.reshape(-1, 3))
        except UnusableMeshError as error:
            raise InputError.at(shown, str(error)) from None
        if coordinates is None:
            coordinates = np.zeros((len(points), 2))
        return Triangles(points, indices.reshape(-1, 3), normals, coordinates)

    def camera(self) -> Json:
        """The first camera of the scene; without one, one that sees everything."""
        if not self.cameras:
            self.findings.note("", "the file has no camera; this one looks at everything from the front")
            middle, size = (self.lowest + self.highest) / 2, float(np.linalg.norm(self.highest - self.lowest))
            away = middle + np.array([0.0, 0.0, 1.5 * size])
            where = {"position": away.tolist(), "look_at": middle.tolist()}
            return {"type": "pinhole", "vertical_field_of_view_degrees": 40.0, **where}
        index, matrix = self.cameras[0]
        if len(self.cameras) > 1:
            self.findings.note("", f"of {len(self.cameras)} cameras the first is used")
        entry = self.container.item("cameras", index, "a node")
        place = f"cameras[{index}]"
        ahead, up = (
            -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2]),
            matrix[:3, 1] / np.linalg.norm(matrix[:3, 1]),
        )
        sensor: Json = {
            "position": matrix[:3, 3].tolist(),
            "look_at": (matrix[:3, 3] + ahead).tolist(),
            "up": up.tolist(),
        }
        if entry.get("type") == "orthographic":
            height = 2 * number(self.container, entry.get("orthographic"), "ymag", 1.0, place)
            return {"type": "orthographic", **sensor, "height": height}
        perspective = entry.get("perspective")
        aspect = number(self.container, perspective, "aspectRatio", 1.0, place)
        if aspect > 0:
            self.writer.film.width = max(1, min(4096, round(self.writer.film.height * aspect)))
        field = math.degrees(number(self.container, perspective, "yfov", 0.7, place))
        return {"type": "pinhole", **sensor, "vertical_field_of_view_degrees": field}

    def add_light(self, index: int, matrix: Matrix) -> None:
        """A lamp of KHR_lights_punctual: cd or lx, for a colour of luminance 1."""
        tree = value(value(self.container.tree, "extensions", {}), "KHR_lights_punctual", {})
        entries = value(tree, "lights", [])
        if not isinstance(index, int) or not 0 <= index < len(entries):
            raise InputError.at(self.container.at("a node"), "there is no such light")
        entry, place = entries[index], self.container.at(f"lights[{index}]")
        colour = floats(self.container, entry, "color", [1.0] * 3, f"lights[{index}]")
        power = colours.light(colour, number(self.container, entry, "intensity", 1.0, f"lights[{index}]"))
        if "range" in entry:
            self.findings.note(place, "a lamp's range is left out: light goes on")
        position, ahead = matrix[:3, 3], -matrix[:3, 2]
        kind = value(entry, "type", "")
        if kind == "directional":
            degrees = self.options.light_degrees
            self.findings.note(
                place,
                f"light from one direction became a disc of {degrees:g} degrees and the same irradiance",
            )
            disc = {"direction": (-ahead).tolist(), "angular_diameter_degrees": degrees, "irradiance": power}
            self.writer.add("distant", disc)
            return
        radius = self.options.light_radius
        if radius is None:
            diagonal = float(np.linalg.norm(self.highest - self.lowest))
            radius = 1e-3 * diagonal if math.isfinite(diagonal) and diagonal > 0 else 1e-3
        self.findings.note(
            place, f"the {kind} became a sphere of radius {radius:.4g} m and the same intensity"
        )
        if kind == "point":
            self.writer.add("surfaces", lamps.point(position, radius, power, "point"))
        elif kind == "spot":
            self.writer.add("surfaces", self._spot(entry, f"lights[{index}]", position, ahead, radius, power))
        else:
            raise InputError.at(place, f'no lamp "{str(kind)[:40]}"; expected point, spot or directional')

    def _spot(
        self, entry: Json, place: str, position: Matrix, ahead: Matrix, radius: float, power: Json
    ) -> Json:
        cone = value(entry, "spot", {})
        inner = number(self.container, cone, "innerConeAngle", 0.0, place)
        outer = number(self.container, cone, "outerConeAngle", math.pi / 4, place)
        if not 0 <= inner < outer <= math.pi / 2:
            raise InputError.at(
                self.container.at(place), "expected 0 <= innerConeAngle < outerConeAngle <= pi / 2"
            )
        angles = np.unique(np.concatenate([[0.0, math.pi], [outer + 2e-5], np.linspace(inner, outer, 65)]))
        # The extension's own suggestion: the square of a ramp over the cosine.
        ramp = (np.cos(angles) - math.cos(outer)) / (math.cos(inner) - math.cos(outer))
        part = np.clip(ramp, 0.0, 1.0) ** 2
        return lamps.spot(self.writer, position, ahead, radius, power, (np.degrees(angles), part), "spot")


def import_gltf(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    """Read a scene into a writer. Raises InputError."""
    container = open_container(file.resolve(), options.root or file.resolve().parent)
    tree = container.tree
    for name in value(tree, "extensionsRequired", []):
        if name not in _KNOWN:
            findings.lost(
                container.shown, f"no equal of the extension {str(name)[:80]}, which the file requires"
            )
    if value(tree, "animations", []):
        findings.note(container.shown, "animations are left out: everything is as at rest")
    materials = Materials(container, writer, findings)
    bounds = np.full(3, np.inf), np.full(3, -np.inf)
    reader = _Reader(container, writer, findings, options, materials, *bounds, [], [])
    scene = container.item("scenes", value(tree, "scene", 0), "the file")
    for index in value(scene, "nodes", []):
        reader.node(index, transforms.IDENTITY, ())
    for light, matrix in reader.lights:
        reader.add_light(light, matrix)
    if not writer.document.get("surfaces"):
        raise InputError.at(container.shown, "the scene has no surface that can be imported")
    writer.document["sensor"] = reader.camera()
