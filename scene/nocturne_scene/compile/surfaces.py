"""Surfaces: shape, kernel, interior, and maps of normals and heights."""

from nocturne.v1 import scene_pb2

from nocturne_scene.compile.kernels import Kernels
from nocturne_scene.compile.media import Media
from nocturne_scene.compile.placement import placements_of
from nocturne_scene.compile.shapes import Shapes, put_shape
from nocturne_scene.compile.textures import Textures
from nocturne_scene.compile.workspace import Workspace
from nocturne_scene.document.kernels import NullKernel
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.document.textures import ColourTexture


class Surfaces:
    """Compiles surfaces."""

    def __init__(
        self, workspace: Workspace, textures: Textures, shapes: Shapes, kernels: Kernels, media: Media
    ) -> None:
        self._workspace = workspace
        self._textures = textures
        self._shapes = shapes
        self._kernels = kernels
        self._media = media

    def compile(self, surface: Surface, group: int, place: str) -> scene_pb2.Surface:
        """Return a surface; parts that can't be compiled are noted and left out."""
        message = scene_pb2.Surface(group=group)
        kernel = self._kernels.compile(surface.kernel or NullKernel(type="null"), f"{place}.kernel")
        needs_coordinates = False
        if kernel is not None:
            interior = self._media.interior(surface.interior, kernel.interior, f"{place}.interior")
            message.kernel = kernel.front
            if kernel.back is not None:
                message.back_kernel = kernel.back
            if interior is not None:
                message.interior = interior
            needs_coordinates = kernel.needs_coordinates
        luminaire = surface.luminaire
        needs_coordinates |= luminaire is not None and isinstance(luminaire.radiance, ColourTexture)
        if surface.normal_map is not None:
            needs_coordinates = True
            with self._workspace.problems_at(f"{place}.normal_map"):
                message.normal_map.CopyFrom(self._textures.normals(surface.normal_map))
        if surface.bump_map is not None:
            needs_coordinates = True
            with self._workspace.problems_at(f"{place}.bump_map"):
                message.bump_map.CopyFrom(self._textures.heights(surface.bump_map))
        with self._workspace.problems_at(f"{place}.shape"):
            steps = placements_of(surface)
            if group == 0:
                steps = [self._workspace.frame.after(step) for step in steps]
            self._workspace.report_motion(surface.motion, len(steps), place)
            shape = self._shapes.compile(
                surface.shape, steps, f"{place}.shape", coordinates=needs_coordinates
            )
            put_shape(message, shape)
        return message
