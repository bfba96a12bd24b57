"""A whole scene of glTF: its nodes, and the meshes, cameras and lamps on them."""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read import meshopt
from nocturne_scene.formats.gltf.read.container import (
    Container,
    Json,
    floats,
    number,
    open_container,
    unused_extensions,
    value,
)
from nocturne_scene.formats.gltf.read.materials import KNOWN, Materials
from nocturne_scene.formats.gltf.read.pictures import Pictures
from nocturne_scene.formats.gltf.read.poses import Poses, poses_at
from nocturne_scene.formats.gltf.read.primitives import Primitive, Skin, read_primitive
from nocturne_scene.formats.reading import colours, shapes, transforms
from nocturne_scene.formats.reading.baking import bake
from nocturne_scene.formats.reading.crowds import Crowds
from nocturne_scene.formats.reading.extent import Extent
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.lamps import Lamps
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_writer import SceneWriter
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.meshes.triangles import Triangles

_KNOWN = (
    *KNOWN,
    *meshopt.NAMES,
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_variants",
    "KHR_mesh_quantization",
    "KHR_draco_mesh_compression",
    "KHR_texture_transform",
)
# Of nodes.
_OF_NODES = ("KHR_lights_punctual", "EXT_mesh_gpu_instancing")
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
    poses: Poses
    extent: Extent = field(default_factory=Extent)
    crowds: Crowds = field(init=False)
    """Instances."""
    nodes: list[tuple[int, Matrix]] = field(default_factory=list)
    cameras: list[tuple[int, Matrix]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.crowds = Crowds(self.writer, self.findings)

    def node(self, index: Json, outer: Matrix, above: tuple[Json, ...]) -> None:
        """Place a node and all below it."""
        if index in above or len(above) >= _MAX_DEPTH or len(self.nodes) >= _MAX_NODES:
            raise InputError.at(
                self.container.at(f"nodes[{index}]"), "nodes are nested too deep, or in themselves"
            )
        entry = self.container.item("nodes", index, "a scene")
        matrix = outer @ self.poses.matrix(index, entry, f"nodes[{index}]")
        self.nodes.append((index, matrix))
        if "camera" in entry:
            self.cameras.append((entry["camera"], matrix))
        for child in value(entry, "children", []):
            self.node(child, matrix, (*above, index))

    def add_meshes(self) -> None:
        """The meshes of all nodes."""
        for index, matrix in self.nodes:
            entry = self.container.item("nodes", index, "a scene")
            unused_extensions(entry, _OF_NODES, self.findings, self.container.at(f"nodes[{index}]"))
            if "mesh" not in entry:
                continue
            skin = self._skin(entry["skin"], f"nodes[{index}]") if "skin" in entry else None
            if "EXT_mesh_gpu_instancing" in value(entry, "extensions", {}):
                self._instances(index, entry, matrix, f"nodes[{index}]")
            else:
                # Of a mesh with a skin only the joints say where it is.
                self._mesh(index, entry, transforms.IDENTITY if skin else matrix, skin)
        _, instances = self.crowds.written()
        for instance in instances:
            self.writer.add("instances", instance)

    def _instances(self, index: int, entry: Json, matrix: Matrix, place: str) -> None:
        """Copies of a node's mesh: instances of one group, or meshes where one is stretched or mirrored."""
        copies = self._copies(entry, matrix, place)
        if not all(transforms.is_even(each) for each in copies):
            for each in copies:
                self._mesh(index, entry, each, None)
            return
        before = len(self.writer.document.get("surfaces", []))
        outer, self.extent = self.extent, Extent()
        self._mesh(index, entry, transforms.IDENTITY, None)
        members = self.writer.document.get("surfaces", [])[before:]
        if not members:
            self.extent = outer
            return
        del self.writer.document["surfaces"][before:]
        group = self.writer.name("groups", str(entry.get("name") or "copies"), members)
        ends = np.stack(np.meshgrid(*np.stack([self.extent.lowest, self.extent.highest], 1)), -1).reshape(
            -1, 3
        )
        for each in copies:
            self.crowds.instance(group, each)
            outer.add(ends @ each[:3, :3].T + each[:3, 3])
        self.extent = outer

    def _copies(self, entry: Json, matrix: Matrix, place: str) -> list[Matrix]:
        """Where EXT_mesh_gpu_instancing puts a node's mesh."""
        extension = value(entry["extensions"], "EXT_mesh_gpu_instancing", {})
        given = {
            name: self.container.numbers(index, place, "VEC3", "VEC4")
            for name, index in value(extension, "attributes", {}).items()
            if name in ("TRANSLATION", "ROTATION", "SCALE")
        }
        counts = {len(each) for each in given.values()}
        if len(counts) != 1 or max(counts) > _MAX_NODES:
            raise InputError.at(self.container.at(place), "its copies have different counts, or are too many")
        names = {"TRANSLATION": "translation", "ROTATION": "rotation", "SCALE": "scale"}
        rows = (
            {names[name]: each[row].tolist() for name, each in given.items()} for row in range(counts.pop())
        )
        return [np.asarray(matrix @ self.poses.matrix(-1, row, place)) for row in rows]

    def _skin(self, index: Json, place: str) -> Skin:
        entry = self.container.item("skins", index, place)
        place = f"skins[{index}]"
        joints, where = value(entry, "joints", []), dict(self.nodes)
        if not joints or any(joint not in where for joint in joints):
            raise InputError.at(self.container.at(place), "has joints that are no nodes of the scene")
        matrices = np.stack([where[joint] for joint in joints])
        if "inverseBindMatrices" in entry:
            bound = self.container.numbers(entry["inverseBindMatrices"], place, "MAT4")
            if len(bound) < len(joints):
                raise InputError.at(self.container.at(place), "has fewer matrices than joints")
            # By columns.
            matrices = matrices @ bound[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
        return Skin(matrices)

    def _mesh(self, node: int, entry: Json, matrix: Matrix, skin: Skin | None) -> None:
        mesh = self.container.item("meshes", entry["mesh"], "a node")
        primitives = value(mesh, "primitives", [])
        for number_, primitive in enumerate(primitives if isinstance(primitives, list) else []):
            place = f"meshes[{entry['mesh']}].primitives[{number_}]"
            targets = value(primitive, "targets", [])
            weights = self.poses.weights(node, entry, mesh, len(targets), f"nodes[{node}]") if targets else []
            with self.findings.leaving_out():
                self._primitive(
                    primitive, str(mesh.get("name") or f"mesh-{entry['mesh']}"), weights, matrix, skin, place
                )

    def _primitive(
        self, primitive: Json, name: str, weights: list[float], matrix: Matrix, skin: Skin | None, place: str
    ) -> None:
        material = value(primitive, "material", None)
        frame = self.materials.frame(material)
        coordinates = frame.number, frame.matrix
        found = read_primitive(self.container, self.findings, primitive, weights, skin, coordinates, place)
        if found is None:
            return
        triangles, tint = self._tinted(found, material, place)
        placed = shapes.transformed(triangles, matrix)
        surface = self.materials.surface(material, tint)
        shape = self.writer.mesh(name, placed)
        self.extent.add(placed.vertices)
        self.writer.add("surfaces", {"name": name, **surface, "shape": shape})

    def _tinted(
        self, primitive: Primitive, material: Json, place: str
    ) -> tuple[Triangles, np.ndarray | None]:
        """Triangles, and their colours as one of all or as a picture on separate coordinates."""
        colours_ = primitive.colours
        if colours_ is None or np.all(colours_ == colours_[0]):
            return primitive.triangles, None if colours_ is None else colours_[0]
        if self.materials.is_textured(material):
            self.findings.lost(
                self.container.at(place),
                "no support for colours at vertices together with textures; their mean is taken",
            )
            return primitive.triangles, colours_.mean(axis=0)
        triangles, picture = bake(primitive.triangles, colours_[primitive.triangles.indices], place)
        return triangles, np.clip(picture, 0.0, 1.0)

    def camera(self) -> Json:
        """The first camera of the scene; without one, one that sees everything."""
        if not self.cameras:
            self.findings.note("", "the file has no camera; this one looks at everything from the front")
            middle, size = (self.extent.lowest + self.extent.highest) / 2, self.extent.diagonal
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
        lamps = Lamps(self.writer, self.findings, self.options, self.extent)
        if kind == "directional":
            lamps.far(-ahead, power, place)
        elif kind == "point":
            lamps.point(position, power, "point", place)
        elif kind == "spot":
            lamps.spot(position, ahead, power, self._spot(entry, f"lights[{index}]"), "spot", place)
        else:
            raise InputError.at(place, f'no lamp "{str(kind)[:40]}"; expected point, spot or directional')

    def _spot(self, entry: Json, place: str) -> tuple[Matrix, Matrix]:
        """Degrees from the axis of a spot, and the part of the intensity there."""
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
        return np.degrees(angles), np.clip(ramp, 0.0, 1.0) ** 2


def import_gltf(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    """Read a scene into a writer. Raises InputError."""
    container = open_container(file.resolve(), options.root or file.resolve().parent)
    tree = container.tree
    for name in value(tree, "extensionsRequired", []):
        if name not in _KNOWN:
            findings.lost(
                container.shown, f"no support for the extension {str(name)[:80]}, which the file requires"
            )
    if "KHR_materials_variants" in value(tree, "extensions", {}):
        findings.note(
            container.shown, "of a material's variants the one that a file shows by itself is taken"
        )
    materials = Materials(container, writer, findings, Pictures(container, writer, findings))
    poses = poses_at(container, findings, options.time)
    reader = _Reader(container, writer, findings, options, materials, poses)
    scene = container.item("scenes", value(tree, "scene", 0), "the file")
    for name in {**value(tree, "extensions", {}), **value(scene, "extensions", {})}:
        if "light" in name.lower() and name not in _KNOWN:
            findings.lost(container.shown, f"no support for the extension {name[:80]}; its light is left out")
    for index in value(scene, "nodes", []):
        reader.node(index, transforms.IDENTITY, ())
    reader.add_meshes()
    for index, matrix in reader.nodes:
        extensions = value(container.item("nodes", index, "a scene"), "extensions", {})
        light = value(value(extensions, "KHR_lights_punctual", {}), "light", None)
        if light is not None:
            with findings.leaving_out():
                reader.add_light(light, matrix)
    if not writer.document.get("surfaces") and not writer.document.get("instances"):
        raise InputError.at(container.shown, "the scene has no surface that can be imported")
    writer.document["sensor"] = reader.camera()
