"""Area lights of pbrt's, on shapes that may have holes."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.pbrt.read import spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameters
from nocturne_scene.formats.reading import colours, lamps
from nocturne_scene.formats.reading.crowds import Placed
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.triangles import Triangles, area_vectors

Areas = NDArray[np.float64]

# Of quadrics of radius 1, and of height 1.
_UNITS = {"sphere": 4 * np.pi, "disk": np.pi, "cylinder": 2 * np.pi}
# By which areas may differ: meshes are written in single precision.
_ALIKE = 1e-3


def opacity(context: Context, parameters: Parameters) -> Json:
    """A shape's `alpha`: a number from 0 to 1, or a use of a texture."""
    found = spectra.scalar(context, parameters, "alpha", 1.0)
    return min(max(float(found), 0.0), 1.0) if isinstance(found, float | int) else found


def shines(context: Context, kernel: Json, *, of_object: bool) -> bool:
    """Whether a shape of a kernel has the `AreaLightSource` of now."""
    if context.state.area_light is None:
        return False
    nowhere = (
        'of an "interface" material' if kernel == {"type": "null"} else "of objects" if of_object else ""
    )
    if nowhere:
        context.findings.note(context.state.area_light[2], f"no light on shapes {nowhere}, as in pbrt")
    return not nowhere


def luminaire(context: Context, opacity: Json, kind: str, shape: Json | Placed) -> Json:
    """What a shape of an opacity has of the `AreaLightSource` of now.

    Parts that are cut out do not shine. A shape of which nothing is there lights all the same, and no ray
    meets it: DiffuseAreaLight in lights.cpp of pbrt-v4.
    """
    found = _whole(context, kind, shape)
    if opacity == 0.0:
        return found | {"hidden_from": lamps.UNSEEN}
    if isinstance(opacity, float):
        return found | {"radiance": colours.scaled(found["radiance"], opacity)}
    spectrum = colours.scaled(found["radiance"], opacity.get("gain", 1.0))
    use = {key: value for key, value in opacity.items() if key != "gain"}
    return found | {"radiance": {**use, "grey": True, "spectrum": spectrum}}


def _parts(kind: str, shape: Json | Placed, folder: Path) -> Areas | None:
    """Areas, m2, of pbrt's single lights: triangles of a mesh, bilinear patches, whole quadrics."""
    if isinstance(shape, Placed):
        if shape.base.mesh is None:
            return np.array([4 * np.pi * np.linalg.norm(shape.matrix[:3, 0]) ** 2])
        mesh = shape.base.mesh
        of_now, of_unit = (_areas(mesh, matrix).sum() for matrix in (shape.matrix, np.eye(4)))
        # Its triangles have a little less area than the shape.
        return np.array([_UNITS[kind] * of_now / of_unit])
    if kind == "curve" or shape is None:
        return None
    found = _areas(load_mesh(folder / shape["asset"], "ply"), np.eye(4))
    # Of each patch the first triangle stands in the first half.
    return found.reshape(2, -1).sum(axis=0) if kind == "bilinearmesh" else found


def _areas(mesh: Triangles, matrix: Matrix) -> Areas:
    corners = mesh.vertices[mesh.indices] @ matrix[:3, :3].T
    return np.asarray(np.linalg.norm(area_vectors(corners), axis=1) / 2)


def _whole(context: Context, kind_of_shape: str, shape: Json | Placed) -> Json:
    if context.state.area_light is None:
        raise ValueError("there is no area light")
    kind, given, place = context.state.area_light
    parameters = context.parameters("area light", place, given)
    if kind != "diffuse":
        context.findings.lost(place, f'no support for the area light "{kind}"; there is diffuse')
    if parameters.take("filename") is not None:
        context.findings.lost(place, 'no support for an area light\'s "filename"')
    luminance = float(parameters.number("scale", 1.0))
    two_sided = parameters.switch("twosided", False)
    power = float(parameters.number("power", 0.0))
    areas = _parts(kind_of_shape, shape, context.writer.folder) if power > 0 else None
    if power > 0 and (areas is None or areas.min() < (1 - _ALIKE) * areas.max()):
        context.findings.lost(
            place,
            'no support for an area light\'s "power" on parts of several sizes: each has all of it in pbrt',
        )
    elif power > 0 and areas is not None:
        luminance *= power / (np.pi * float(areas.mean()) * (2 if two_sided else 1))
    radiance = spectra.light(context, parameters, "L", luminance)
    parameters.finish()
    return {"radiance": radiance} | ({"two_sided": True} if two_sided else {})
