"""The render engine: a scene goes to the service, and its image comes back as it grows."""

import time
from contextlib import suppress
from typing import Any

import bpy
import numpy as np

from . import light, local_service, settings
from .film import TiledImage
from .panels import ENGINE
from .scene import NothingToRender, read
from .service import Job, Service, ServiceError, has_ended

Json = Any

# Between looks at the service.
_INTERVAL_S = 0.25
# Passes besides the combined image: name, channels, their letters, kind.
_PASSES = (("XYZ", 3, "XYZ", "COLOR"), ("Y Error", 1, "X", "VALUE"), ("Samples", 1, "X", "VALUE"))


class Cancelled(Exception):
    """Whoever asked for the image wants it no more."""


class NocturneEngine(bpy.types.RenderEngine):
    """Nocturne, as Blender calls it."""

    bl_idname = ENGINE
    bl_label = "Nocturne"
    bl_use_preview = False
    bl_use_postprocess = True
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True

    def update_render_passes(self, scene: Any = None, renderlayer: Any = None) -> None:
        """Registers the passes with the compositor."""
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for name, channels, letters, kind in _PASSES:
            self.register_pass(scene, renderlayer, name, channels, letters, kind)

    def render(self, depsgraph: Any) -> None:
        """One frame: Blender calls this for each of an animation."""
        try:
            self._render(depsgraph)
        except Cancelled:
            pass
        except (ServiceError, NothingToRender, ValueError) as error:
            self.error_set(f"Nocturne: {error}")
            self.report({"ERROR"}, f"Nocturne: {error}")

    def _render(self, depsgraph: Any) -> None:
        scene = depsgraph.scene
        wanted = scene.nocturne
        self.update_stats("", "Reading the scene")
        sent = read(depsgraph, lambda frame, part: self.frame_set(frame, subframe=part))
        for sentence in sent.findings.sentences:
            self.report({"WARNING"}, sentence)
        service = Service(wanted.url, settings.token(), self._waits)
        if wanted.start_here:
            self.update_stats("", "Waiting for the service")
            local_service.ensure(service, wanted.url, settings.program(), settings.data_folder())
        for part in service.upload(sent.files.by_digest):
            self.update_stats("", f"Sending files: {part:.0%}")
            self._stop_if_asked()
        # In whole numbers, as Blender: 720 at 35 % is 252, where a product of fractions is just below it.
        percentage = scene.render.resolution_percentage
        width = scene.render.resolution_x * percentage // 100
        height = scene.render.resolution_y * percentage // 100
        job = Job(
            f"{scene.name}, frame {scene.frame_current}"[:200],
            sent.document,
            width,
            height,
            wanted.samples,
            _stop(wanted),
        )
        self.update_stats("", "Sending the scene")
        self._follow(service, service.create(job), TiledImage(width, height))

    def _follow(self, service: Service, render: Json, film: TiledImage) -> None:
        for name, channels, letters, _ in _PASSES:
            self.add_pass(name, channels, letters)
        result = self.begin_result(0, 0, film.width, film.height)
        identity = render["id"]
        try:
            while True:
                self._stop_if_asked()
                # First the state, then tiles: the last tiles are fetched after the end.
                render = service.render(identity)
                self._tell(render)
                if self._fetch(service, identity, film):
                    _show(result, film)
                    self.update_result(result)
                if has_ended(render):
                    break
                time.sleep(_INTERVAL_S)
        except (Cancelled, ServiceError):
            # Nobody looks at it any more.
            with suppress(ServiceError):
                service.cancel(identity)
            raise
        finally:
            self.end_result(result)
        if render["state"] == "FAILED" or render["state"] == "CANCELLED":
            raise ServiceError(f"the render is {render['state'].lower()}: {render['reason']}")
        if error_warning := render["progress"]["error_warning"]:
            self.report({"WARNING"}, f"Its error is not to be trusted: {error_warning}")

    def _fetch(self, service: Service, identity: str, film: TiledImage) -> bool:
        """Takes all tiles that changed; tells whether any did."""
        any_changed = False
        while answer := service.tiles(identity, film.cursor):
            before = film.cursor
            more = film.take(answer)
            any_changed = any_changed or film.cursor != before
            if not more:
                break
            self._stop_if_asked()
        return any_changed

    def _tell(self, render: Json) -> None:
        progress = render["progress"]
        samples, error = progress["mean_samples"], progress["relative_error"]
        said = f"{samples:.0f} of {render['samples']} samples per pixel"
        self.update_stats("", said + (f", error {error:.2%}" if error else ""))
        self.update_progress(min(1.0, samples / render["samples"]))

    def _waits(self, why: str, seconds: float) -> None:
        self.update_stats("", f"{why}; asking again in {seconds:.0f} s")
        self._stop_if_asked()

    def _stop_if_asked(self) -> None:
        if self.test_break():
            raise Cancelled


def _stop(wanted: Any) -> Json:
    """Conditions of the service, those that are set."""
    asked = {
        "relative_error": wanted.error / 100,
        "wall_seconds": wanted.seconds,
        "until": wanted.until.strip(),
    }
    return {name: value for name, value in asked.items() if value}


def _show(result: Any, film: TiledImage) -> None:
    """Puts the film into the passes."""
    rgba = np.ones((film.height, film.width, 4), np.float32)
    rgba[..., :3] = light.rgb_of_xyz(film.xyz)
    found = {"Combined": rgba, "XYZ": film.xyz, "Y Error": film.y_error, "Samples": film.samples}
    passes = result.layers[0].passes
    for name, pixels in found.items():
        if name in passes:
            passes[name].rect.foreach_set(pixels.ravel())


def register() -> None:
    """Puts the engine into Blender's list."""
    bpy.utils.register_class(NocturneEngine)


def unregister() -> None:
    """Takes it out."""
    bpy.utils.unregister_class(NocturneEngine)
