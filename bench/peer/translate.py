"""A compiled scene as a description that Mitsuba 3 loads: the same scene, not a look-alike.

It is made of the compiled scene, so that both have the same tables, matrices and triangles. What has no
equal in Mitsuba is refused. Known differences that remain: Mitsuba's rough conductor multiplies the shadowing
of both directions, ours correlates them by height (less shadow at grazing angles: 1 % at 75 degrees and
roughness 0.2); its colour matching functions are tabulated each 5 nm, up to 0.1 % on coloured patches; it
interpolates between the texels of an environment map.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
from nocturne.v1 import scene_pb2
from nocturne_client.errors import NocturneClientError
from nocturne_coordinator.blobs import BlobStore
from scipy.interpolate import CubicSpline

from bench.peer.scenes import write_grey
from bench.programs import Channel, read_channels

Description = dict[str, Any]

# Mitsuba's film divides by this, which is nearly its integral of y-bar: MI_CIE_Y_NORMALIZATION in its
# include/mitsuba/core/spectrum.h.
_FILM_DIVISOR = 106.7502593994140625
CANDELAS_PER_UNIT = 683.0 * _FILM_DIVISOR
"""Luminance in cd/m2 of an image value Y = 1 of Mitsuba's, radiance being in W m-2 sr-1 nm-1."""

# The range of its colour matching functions, nm.
_FIRST_NM, _LAST_NM = 360.0, 830.0


class Translation:
    """One scene's description; files that it names go into `folder`."""

    def __init__(self, scene: scene_pb2.CompiledScene, blobs: BlobStore, folder: Path, sky: Path) -> None:
        """`sky`: the picture that the compiled scene's environment map, if any, was made of."""
        self._scene = scene
        self._blobs = blobs
        self._folder = folder
        self._sky = sky

    def description(self) -> Description:
        """Integrator, surfaces and light, no sensor. NocturneClientError where it has no equal."""
        scene = self._scene
        if scene.instances or scene.distant_discs:
            raise _no_equal("instances and distant discs")
        lit = {luminaire.surface: luminaire for luminaire in scene.luminaires}
        found: Description = {"type": "scene", "integrator": {"type": "path", "max_depth": -1}}
        for index, kernel in enumerate(scene.kernels):
            found[f"kernel{index}"] = {**self._kernel(kernel), "id": f"kernel{index}"}
        for index, surface in enumerate(scene.surfaces):
            found[f"surface{index}"] = self._surface(index, surface, lit.get(index))
        if scene.HasField("environment"):
            found["environment"] = self._environment(scene.environment)
        return found

    def sensor(self, width: int, height: int, sampler: str) -> Description:
        """The camera and its film."""
        sensor = self._scene.sensor
        if sensor.lens_radius > 0 or sensor.later_poses:
            raise _no_equal("lens or motion")
        position, forward = _array(sensor.position), _array(sensor.forward)
        # Its x points to the left.
        axes = [-_array(sensor.right), _array(sensor.up), forward]
        film = {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "pixel_format": "xyz",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        }
        common = {"film": film, "sampler": {"type": sampler}}
        if sensor.model == scene_pb2.SENSOR_MODEL_ORTHOGRAPHIC:
            half_width = 0.5 * sensor.height * width / height
            # It sees -1 to 1 in x, and as much in y as the film's shape gives.
            to_world = _matrix([axes[0] * half_width, axes[1] * half_width, axes[2]], position)
            return {"type": "orthographic", "to_world": to_world, **common}
        if sensor.model == scene_pb2.SENSOR_MODEL_PERSPECTIVE:
            return {
                "type": "perspective",
                "to_world": _matrix(axes, position),
                "fov_axis": "y",
                "fov": math.degrees(sensor.vertical_field_of_view),
                **common,
            }
        raise _no_equal(scene_pb2.SensorModel.Name(sensor.model))

    def _surface(
        self, index: int, surface: scene_pb2.Surface, luminaire: scene_pb2.Luminaire | None
    ) -> Description:
        if surface.HasField("back_kernel") or surface.HasField("interior") or surface.group:
            raise _no_equal("back kernels, interiors and groups")
        found: Description = {"bsdf": {"type": "ref", "id": f"kernel{surface.kernel}"}}
        match surface.WhichOneof("shape"):
            case "sphere":
                ball = surface.sphere
                found |= {"type": "sphere", "center": list(_array(ball.centre)), "radius": ball.radius}
            case "quad":
                # Its rectangle is [-1, 1]^2 in x and y.
                u, v = 0.5 * _array(surface.quad.edge_u), 0.5 * _array(surface.quad.edge_v)
                normal = np.cross(u, v)
                normal /= np.linalg.norm(normal)
                middle = _array(surface.quad.corner) + u + v
                found |= {"type": "rectangle", "to_world": _matrix([u, v, normal], middle)}
            case _:
                found |= {
                    "type": "ply",
                    "filename": str(self._mesh(index, surface.mesh)),
                    "face_normals": True,
                }
        if luminaire is not None:
            if (
                luminaire.two_sided
                or luminaire.WhichOneof("profile")
                or luminaire.radiance.HasField("texture")
            ):
                raise _no_equal("luminaires with two sides, a profile or a texture")
            found["emitter"] = {"type": "area", "radiance": self._spectrum(luminaire.radiance.spectrum)}
        return found

    def _kernel(self, kernel: scene_pb2.Kernel) -> Description:
        inner: Description
        model = kernel.WhichOneof("model")
        match model:
            case "lambertian":
                inner = {"type": "diffuse", "reflectance": self._colour(kernel.lambertian.reflectance)}
            case "conductor":
                conductor = kernel.conductor
                alpha = _one_alpha(conductor.roughness)
                inner = {"eta": self._spectrum(conductor.n), "k": self._spectrum(conductor.k)}
                if alpha == 0:
                    inner["type"] = "conductor"
                else:
                    inner |= {"type": "roughconductor", "distribution": "ggx", "alpha": alpha}
            case "coated_diffuse":
                coated = kernel.coated_diffuse
                if _one_alpha(coated.roughness) > 0:
                    raise _no_equal("rough coats")
                inner = {
                    "type": "plastic",
                    "nonlinear": True,
                    "int_ior": self._constant(coated.index),
                    "ext_ior": 1.0,
                    "diffuse_reflectance": self._colour(coated.reflectance),
                }
            case _:
                raise _no_equal(f"the kernel {model}")
        return {"type": "twosided", "bsdf": inner}

    def _environment(self, environment: scene_pb2.Environment) -> Description:
        if environment.WhichOneof("radiance") == "constant":
            return {"type": "constant", "radiance": self._spectrum(environment.constant)}
        pixels = read_channels(self._sky, "RGB")
        if np.any(pixels != pixels[..., :1]):
            raise _no_equal("coloured environment maps")
        path = self._folder / "mitsuba-sky.exr"
        write_grey(path, _rows_at_nodes(pixels[..., 0]))
        frame = environment.map
        # Its picture has +z in the middle, +x to the left of that, and y up.
        axes = [_array(frame.y), _array(frame.z), _array(frame.x)]
        return {
            "type": "envmap",
            "filename": str(path),
            # A grey texel of 1 is D65 of Y = 1.
            "scale": self._luminance(frame.spectrum) / CANDELAS_PER_UNIT,
            "to_world": _matrix(axes, np.zeros(3)),
        }

    def _colour(self, colour: scene_pb2.Colour) -> Description:
        if colour.HasField("texture"):
            raise _no_equal("textures")
        return self._spectrum(colour.spectrum)

    def _constant(self, index: int) -> float:
        spectrum = self._scene.spectra[index]
        if any(value != spectrum.values[0] for value in spectrum.values):
            raise _no_equal("dispersion")
        return float(spectrum.values[0])

    def _spectrum(self, index: int) -> Description:
        spectrum = self._scene.spectra[index]
        values = np.array(spectrum.values, dtype=np.float64)
        if len(values) == 1:
            return {"type": "uniform", "value": float(values[0])}
        first, last = spectrum.first_nm, spectrum.first_nm + spectrum.step_nm * (len(values) - 1)
        if not spectrum.zero_outside:
            # Its tables are zero outside.
            before = max(0, math.ceil((first - _FIRST_NM) / spectrum.step_nm))
            after = max(0, math.ceil((_LAST_NM - last) / spectrum.step_nm))
            values = np.pad(values, (before, after), mode="edge")
            first, last = first - before * spectrum.step_nm, last + after * spectrum.step_nm
        return {
            "type": "regular",
            "wavelength_min": first,
            "wavelength_max": last,
            "values": ", ".join(f"{value:.9g}" for value in values),
        }

    def _luminance(self, index: int) -> float:
        """Of a spectrum, cd/m2, by the sensor's own response."""
        spectrum, sensor = self._scene.spectra[index], self._scene.sensor
        response = np.array(sensor.response_y)
        at = sensor.response_first_nm + sensor.response_step_nm * np.arange(len(response))
        knots = spectrum.first_nm + spectrum.step_nm * np.arange(len(spectrum.values))
        outside = 0.0 if spectrum.zero_outside else None
        values = np.interp(at, knots, np.array(spectrum.values), left=outside, right=outside)
        return float(np.sum(response * values) * sensor.response_step_nm)

    def _mesh(self, index: int, mesh: scene_pb2.Mesh) -> Path:
        if mesh.normals or mesh.texture_coordinates or mesh.time_steps > 1:
            raise _no_equal("meshes with normals, texture coordinates or motion")
        blob = self._blobs.path(mesh.blob.hex()).read_bytes()
        split = mesh.vertex_count * 12
        triangles = np.frombuffer(blob, "<u4", mesh.triangle_count * 3, split).reshape(-1, 3)
        faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
        faces["count"], faces["corners"] = 3, triangles
        header = (
            f"ply\nformat binary_little_endian 1.0\nelement vertex {mesh.vertex_count}\n"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {mesh.triangle_count}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        path = self._folder / f"mesh{index}.ply"
        path.write_bytes(header.encode() + blob[:split] + faces.tobytes())
        return path


def _rows_at_nodes(grey: Channel) -> Channel:
    """A picture of the same sky for Mitsuba, whose first row is at the zenith and whose last is at the nadir.

    (Our rows, as most pictures', are areas: the first ends at the zenith.)
    """
    rows = len(grey)
    spline = CubicSpline((np.arange(rows) + 0.5) / rows, grey, axis=0)
    nodes: Channel = np.maximum(spline(np.arange(rows) / (rows - 1)), 0.0)
    return nodes


def _one_alpha(roughness: scene_pb2.Roughness) -> float:
    u, v = roughness.alpha_u, roughness.alpha_v
    if "texture" in (u.WhichOneof("source"), v.WhichOneof("source")) or u.constant != v.constant:
        raise _no_equal("anisotropic or textured roughness")
    return u.constant


def _array(vector: scene_pb2.Vector) -> Channel:
    return np.array([vector.x, vector.y, vector.z])


def _matrix(axes: list[Channel], origin: Channel) -> list[list[float]]:
    """From local coordinates to the scene's, rows of a 4 x 4 matrix."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack(axes)
    matrix[:3, 3] = origin
    rows: list[list[float]] = matrix.tolist()
    return rows


def _no_equal(what: str) -> NocturneClientError:
    return NocturneClientError(f"{what}: no equal in Mitsuba, so the bench can't compare it")
