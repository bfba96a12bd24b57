"""A Blender scene as a scene document with its files."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from . import cameras, hair, volumes
from .files import Files, placements
from .findings import Findings
from .images import Images
from .lamps import Lamps
from .materials import Materials
from .meshes import Part, parts_of
from .motion import Movements, SetFrame, camera_matrix, key_of
from .placing import placement
from .world import environment

Json = Any

# Instances of one thing; of more a file holds the placements, as a document has at most 8 MiB.
_LISTED = 1000
_WITH_GEOMETRY = ("MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES")


class NothingToRender(Exception):
    """A scene without a camera."""


@dataclass(frozen=True)
class SentScene:
    """The request to the service, and its files."""

    document: Json
    files: Files
    findings: Findings


@dataclass(frozen=True)
class _Shown:
    """An object, where it is seen."""

    thing: Any
    matrix: Any
    motion: Json
    """Fields of its surface or instance."""


def read(depsgraph: Any, set_frame: SetFrame) -> SentScene:
    """The document of an evaluated scene; raises NothingToRender.

    `set_frame` evaluates the scene at another frame and part of one, for what moves.
    """
    scene = depsgraph.scene_eval
    if scene.camera is None:
        raise NothingToRender("the scene has no camera")
    files, findings = Files(), Findings()
    movements = Movements(findings)
    if scene.render.use_motion_blur:
        movements.record(depsgraph, set_frame)
        scene = depsgraph.scene_eval
    camera = scene.camera.evaluated_get(depsgraph)
    camera_moves = movements.of("camera", camera_matrix(depsgraph), camera.name, scales=False)
    images = Images(files, findings)
    document: Json = {
        "nocturne": 1,
        "name": scene.name,
        "kernels": {},
        "media": {},
        "groups": {},
        "sensor": cameras.sensor(scene, camera, findings) | camera_moves,
        "surfaces": [],
        "instances": [],
        "distant": [],
    }
    lamps = Lamps(document, files, findings)
    materials = Materials(document, images, findings)
    sky = environment(scene.world, images, findings)
    if sky is not None:
        document["environment"] = sky
    objects = _Objects(document, files, findings, materials, depsgraph)
    shown: dict[int, list[_Shown]] = defaultdict(list)
    for instance in depsgraph.object_instances:
        if not instance.show_self:
            continue
        thing = instance.object
        matrix = instance.matrix_world.copy()
        is_lamp = thing.type == "LIGHT"
        motion = movements.of(key_of(instance), matrix, thing.name, scales=not is_lamp)
        if is_lamp:
            lamps.add(thing, matrix, motion)
        elif thing.type in _WITH_GEOMETRY:
            # An object that is shown more than once has one evaluated geometry.
            key = hash((thing.data.session_uid, thing.data.as_pointer(), _materials_of(thing)))
            shown[key].append(_Shown(thing.original.evaluated_get(depsgraph), matrix, motion))
        elif thing.type == "VOLUME":
            objects.add_volume(_Shown(thing.original.evaluated_get(depsgraph), matrix, motion))
        elif thing.type == "POINTCLOUD":
            findings.lost(thing.name, f"no support for an object of the type {thing.type}; left out")
    for places in shown.values():
        objects.add(places)
    return SentScene({key: part for key, part in document.items() if part not in ({}, [])}, files, findings)


def _materials_of(thing: Any) -> tuple[str, ...]:
    return tuple(_name(slot.material) for slot in thing.material_slots)


def _name(material: Any) -> str:
    return "" if material is None else str(material.name_full)


class _Objects:
    """Puts geometry into a document."""

    def __init__(
        self, document: Json, files: Files, findings: Findings, materials: Materials, depsgraph: Any
    ) -> None:
        self._document, self._files, self._findings = document, files, findings
        self._materials, self._depsgraph = materials, depsgraph

    def add(self, places: list[_Shown]) -> None:
        """One geometry, at one or many places."""
        even = [
            (each, found | each.motion) for each in places if (found := placement(each.matrix)) is not None
        ]
        stretched = [each for each in places if placement(each.matrix) is None]
        for each in stretched:
            copies = self._surfaces(each, each.matrix)
            self._document["surfaces"] += [copy | each.motion for copy in copies]
        if not even:
            return
        members = list(self._surfaces(even[0][0], None))
        if not members:
            return
        if len(even) == 1 or any("luminaire" in member for member in members):
            self._document["surfaces"] += [member | where for _, where in even for member in members]
            return
        name = f"group {len(self._document['groups']) + 1}"
        self._document["groups"][name] = members
        at_rest = [where for _, where in even if "motion" not in where]
        if len(at_rest) > _LISTED:
            asset = self._files.add(placements(at_rest))
            self._document["instances"].append({"group": name, "placements": {"asset": asset}})
            even = [each for each in even if "motion" in each[1]]
        self._document["instances"] += [{"group": name} | where for _, where in even]

    def add_volume(self, shown: _Shown) -> None:
        """An OpenVDB file, at one place."""
        slots = shown.thing.material_slots
        fields = self._materials.fields(slots[0].material if len(slots) else None)
        where = placement(shown.matrix)
        found = volumes.surface(shown, where, fields, self._document, self._files, self._findings)
        if found is not None:
            self._document["surfaces"].append(found | shown.motion)

    def _parts(self, thing: Any, transform: Any) -> list[Part]:
        if thing.type == "CURVES":
            return hair.parts_of(thing, self._files, transform)
        return parts_of(thing, self._depsgraph, self._files, transform)

    def _surfaces(self, shown: _Shown, transform: Any) -> Iterator[Json]:
        slots = shown.thing.material_slots
        for part in self._parts(shown.thing, transform):
            material = slots[min(part.slot, len(slots) - 1)].material if len(slots) else None
            fields = self._materials.fields(material)
            if not shown.thing.visible_camera:
                if "luminaire" in fields:
                    fields = fields | {"luminaire": fields["luminaire"] | {"hidden_from": "camera"}}
                else:
                    self._findings.lost(shown.thing.name, "is seen by the camera: only lights can be hidden")
            yield {"shape": part.shape} | fields
