"""Where wavelengths are drawn so that narrow lines in the scene are found.

A wavelength drawn from the response alone, or uniformly, meets a line 0.1 nm wide once in a thousand photons,
and then carries a thousand times the light: noise, and few samples meet none and state no error. So where the
scene has lines narrower than `line_spectra.NARROW`, half of all wavelengths are drawn as without lines, and
half from that density times lines. Other light keeps at least half of its photons, so its noise grows by a
factor of 1.4 at most, while a line's light becomes like any other.
"""

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile.workspace import Workspace
from nocturne_scene.spectra import lines as line_spectra
from nocturne_scene.spectra.published import Floats


def put_wavelength_density(workspace: Workspace, message: scene_pb2.CompiledScene) -> None:
    """Give the sensor of a compiled scene its density, if lines ask for one."""
    found = (workspace.spectra.messages[index].lines for index in _emission(message))
    narrow = [list(lines) for lines in found if any(map(line_spectra.is_narrow, lines))]
    if not narrow:
        return
    uniform = workspace.document.sensor.wavelengths == "uniform"
    importance = np.ones(len(message.sensor.response_x)) if uniform else _importance(message.sensor)
    knots, density = line_spectra.wavelength_density(importance, narrow, within=workspace.wavelengths)
    message.sensor.wavelength_knots.extend(knots.tolist())
    message.sensor.wavelength_density.extend(density.astype(np.float32).tolist())


def _emission(message: scene_pb2.CompiledScene) -> list[int]:
    """The spectra that something emits."""
    found = {luminaire.radiance.spectrum for luminaire in message.luminaires}
    found |= {disc.radiance for disc in message.distant_discs}
    found |= {rays.spectrum for rays in message.ray_sets}
    if message.environment.HasField("constant"):
        found.add(message.environment.constant)
    return sorted(found)


def _importance(sensor: scene_pb2.Sensor) -> Floats:
    """What the tracer draws from without a density: X + Y + Z, and each further response scaled to it."""
    total = np.sum([sensor.response_x, sensor.response_y, sensor.response_z], axis=0)
    importance = np.array(total, dtype=np.float64)
    for response in sensor.further_responses:
        values = np.array(response.values, dtype=np.float64)
        of_all = response.light == scene_pb2.LIGHT_PART_WHOLE and not response.HasField("light_group")
        if values.sum() > 0 and of_all:
            importance += values * (total.sum() / values.sum())
    return importance
