"""Vertices and triangles that are compressed by Draco (KHR_draco_mesh_compression)."""

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read.container import Container, Json, value

NAME = "KHR_draco_mesh_compression"


def decompress(container: Container, primitive: Json, place: str) -> Json:
    """Decode a primitive's vertices into the container, and return it as triangles. Raises InputError."""
    # Few files need it.
    import DracoPy

    extension = value(value(primitive, "extensions", {}), NAME, {})
    shown = container.at(place)
    view = bytes(container.view(value(extension, "bufferView", None), place))
    try:
        mesh = DracoPy.decode(view)
    except Exception as error:  # it raises its own, without a base
        raise InputError.at(shown, f"its Draco data can't be read: {str(error)[:100]}") from None
    if not isinstance(mesh, DracoPy.DracoMesh):
        raise InputError.at(shown, "its Draco data has no triangles")
    stored = {each["unique_id"]: each["data"] for each in mesh.attributes}
    for name, number in value(extension, "attributes", {}).items():
        accessor = value(value(primitive, "attributes", {}), name, None)
        container.item("accessors", accessor, place)
        if not isinstance(number, int) or number not in stored:
            raise InputError.at(shown, f"its Draco data has no attribute {str(number)[:20]}")
        found = np.asarray(stored[number], dtype=np.float64)
        container.decoded[accessor] = found.reshape(len(found), -1)
    faces = np.asarray(mesh.faces, dtype=np.float64).reshape(-1, 1)
    if "indices" in primitive:
        container.item("accessors", primitive["indices"], place)
        container.decoded[primitive["indices"]] = faces
    elif len(faces) != len(mesh.points) or np.any(faces.ravel() != np.arange(len(faces))):
        raise InputError.at(shown, "its Draco data has indices, and it has none")
    return {**primitive, "mode": 4}
