"""Documents without their smallest instances."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.compile.placement import placement_of
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.shapes import AssetMesh, MediumBox, Shape, Sphere
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.placements import read_placements
from nocturne_scene.meshes.simple import simple_mesh
from nocturne_scene.simplify.simplification import Document, Find, Simplification

SHARES = (0.5, 0.9)
"""Parts of the instances, the smallest, that are left out."""

_Box = NDArray[np.float64]


def small_instances(checked: SceneDocument, find: Find) -> Iterator[Simplification]:
    """Without those that look smallest from where the sensor is: radius over distance. Files stay whole."""
    listed = [index for index, each in enumerate(checked.instances) if each.placements is None]
    if len(listed) < 2:
        return
    order = np.array(listed)[np.argsort(_apparent_sizes(checked, find), kind="stable")]
    for share in SHARES:
        left_out = order[: int(share * len(order))]
        if left_out.size:
            name = f"without the {share:.0%} of the instances that look smallest"
            yield Simplification(name, partial(_leave_out, frozenset(left_out.tolist())), kind="instances")


def _leave_out(places: frozenset[int], document: Document) -> None:
    instances = document["instances"]
    document["instances"] = [each for index, each in enumerate(instances) if index not in places]


def _apparent_sizes(document: SceneDocument, find: Find) -> NDArray[np.float64]:
    eye = np.array(document.sensor.position)
    boxes: dict[str, _Box] = {}
    sizes = []
    for instance in document.instances:
        if instance.placements is not None:
            continue
        box = _box_of_group(instance.group, document, find, boxes)
        placement = placement_of(instance)
        centre = placement.points(box.mean(axis=0))
        radius = placement.scale * float(np.linalg.norm(box[1] - box[0])) / 2
        sizes.append(radius / max(float(np.linalg.norm(centre - eye)), radius, 1e-30))
    return np.array(sizes)


def _box_of_group(name: str, document: SceneDocument, find: Find, known: dict[str, _Box]) -> _Box:
    """Lowest and highest coordinates, shape (2, 3); each group once."""
    if name not in known:
        corners = []
        for member in document.groups[name]:
            if isinstance(member, Surface):
                points = _points(member.shape, find)
            else:
                points = _corners(_box_of_group(member.group, document, find, known))
                if member.placements is not None:
                    points = _corners(_box_of_copies(points, find(member.placements.asset)))
            corners.append(placement_of(member).points(points))
        points = np.concatenate(corners)
        known[name] = np.stack([points.min(axis=0), points.max(axis=0)])
    return known[name]


def _box_of_copies(points: NDArray[np.float64], file: Path) -> _Box:
    """A box that holds points wherever a file places them."""
    placed = read_placements(file)
    reach = placed.scales[:, None] * float(np.linalg.norm(points, axis=1).max())
    return np.stack([(placed.shifts - reach).min(axis=0), (placed.shifts + reach).max(axis=0)])


def _points(shape: Shape, find: Find) -> NDArray[np.float64]:
    match shape:
        case Sphere():
            centre = np.array(shape.centre)
            return _corners(np.stack([centre - shape.radius, centre + shape.radius]))
        case AssetMesh():
            return load_mesh(find(shape.asset), shape.resolved_format()).vertices
        case MediumBox():
            # It stands where its grid stands, wherever the instance is.
            return np.zeros((1, 3))
    return simple_mesh(shape).vertices


def _corners(box: _Box) -> NDArray[np.float64]:
    """All eight, shape (8, 3)."""
    return np.stack(np.meshgrid(*box.T, indexing="ij"), axis=-1).reshape(-1, 3)
