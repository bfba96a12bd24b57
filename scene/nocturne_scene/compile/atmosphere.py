"""A planet and its air: two spheres, and media whose densities depend on altitude.

Centre and radii are float64 here and in the message, and the tracer meets spheres in float64, where 6371 km
have steps of 1 nm. Altitudes would be differences of large numbers; they are given from the point of the
ground that is below the origin.
"""

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.compile import spectra
from nocturne_scene.compile.kernel_leaves import null_kernel
from nocturne_scene.compile.media import Media, Substance, above_sphere
from nocturne_scene.compile.sensors import unit, vector
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.atmosphere import Atmosphere
from nocturne_scene.document.problems import path
from nocturne_scene.document.sensors import Sensor
from nocturne_scene.media import presets as media_presets
from nocturne_scene.media import rayleigh
from nocturne_scene.spectra.wavelength_range import WavelengthRange

# nm, at which an aerosol's optical depth is given.
AEROSOL_WAVELENGTH = 550.0

_TOUCHES = 1e-6
"""m; a sensor that lies on the ground. Distances from the Earth's centre are known to 1e-9 m."""

_NOTHING = scene_pb2.Spectrum(values=[0.0])


def atmosphere_surfaces(workspace: Workspace, media: Media) -> list[scene_pb2.Surface]:
    """Return the shell and the ground; none if there is no atmosphere. Problems are noted."""
    atmosphere = workspace.document.atmosphere
    if atmosphere is None:
        return []
    interior = scene_pb2.Interior(index_matched=True, priority=-bounds.PRIORITY)
    with workspace.problems_at("$.sensor"):
        _check_above_ground(atmosphere, workspace.document.sensor)
    with workspace.problems_at("$.atmosphere"):
        interior.media.extend(_layers(atmosphere, media, workspace))
    centre = vector(workspace.frame.points(_centre(atmosphere)))
    index_of = workspace.kernels.index_of
    reflectance = scene_pb2.Colour(spectrum=workspace.reflectance(atmosphere.ground_reflectance))
    ground = scene_pb2.Kernel(lambertian=scene_pb2.Lambertian(reflectance=reflectance))
    top = atmosphere.planet_radius + atmosphere.thickness
    return [
        scene_pb2.Surface(
            sphere=scene_pb2.Sphere(centre=centre, radius=top),
            kernel=index_of(null_kernel()),
            interior=workspace.interiors.index_of(interior),
        ),
        scene_pb2.Surface(
            sphere=scene_pb2.Sphere(centre=centre, radius=atmosphere.planet_radius), kernel=index_of(ground)
        ),
    ]


def _check_above_ground(atmosphere: Atmosphere, sensor: Sensor) -> None:
    """Below it the air grows denser and denser, and photons that start there never come out again."""
    position = getattr(sensor, "position", None)
    if position is None:
        return
    altitude = float(np.linalg.norm(np.array(position) - _centre(atmosphere))) - atmosphere.planet_radius
    if altitude < -_TOUCHES:
        raise Unusable(
            f"is {-altitude:.3g} m below the ground of the atmosphere; the scene's origin is "
            f"{atmosphere.altitude:g} m above it (`$.atmosphere.altitude`)",
            ".position",
        )


def _layers(atmosphere: Atmosphere, media: Media, workspace: Workspace) -> list[int]:
    found, within = [], workspace.spectral
    ground = above_sphere(_centre(atmosphere), atmosphere.planet_radius, workspace.frame)
    if atmosphere.air is not None:
        air = atmosphere.air
        depth = rayleigh.optical_depth(within.grid(), air.pressure)
        scattering = depth / _column(atmosphere, air.scale_height)
        coefficient = spectra.at_grid(scattering, within, zero_outside=False)
        substance = Substance(_NOTHING, coefficient, media.air_phase())
        found.append(media.add(substance, _exponential(ground, air.scale_height)))
    if atmosphere.ozone is not None:
        dobson_units = atmosphere.ozone.dobson_units
        found.append(_ozone(atmosphere, dobson_units, ground, media, within))
    if atmosphere.aerosol is not None:
        aerosol = atmosphere.aerosol
        if workspace.document.media[aerosol.medium].temperature is not None:
            raise Unusable(
                "an aerosol does not glow; expected a medium without temperature", ".aerosol.medium"
            )
        try:
            substance = media.substance(aerosol.medium)
        except Unusable as error:
            raise Unusable(
                f"{path(('media', aerosol.medium))}{error.suffix}: {error}", ".aerosol.medium"
            ) from None
        at = np.array([AEROSOL_WAVELENGTH])
        extinction = float(
            (spectra.evaluate(substance.absorption, at) + spectra.evaluate(substance.scattering, at))[0]
        )
        if not extinction > 0:
            raise Unusable(f"does nothing at {AEROSOL_WAVELENGTH:g} nm", ".aerosol.medium")
        wanted = aerosol.optical_depth / _column(atmosphere, aerosol.scale_height)
        found.append(
            media.add(
                substance.scaled(wanted / extinction),
                _exponential(ground, aerosol.scale_height),
            )
        )
    return found


def _column(atmosphere: Atmosphere, scale_height: float) -> float:
    """The integral of exp(-altitude / scale height) from the ground to where the air ends, m."""
    return float(-scale_height * np.expm1(-atmosphere.thickness / scale_height))


def _ozone(
    atmosphere: Atmosphere,
    dobson_units: float,
    ground: scene_pb2.AltitudeDensity,
    media: Media,
    within: WavelengthRange,
) -> int:
    layer = media_presets.ozone_layer()
    if layer[-1, 0] > atmosphere.thickness:
        raise Unusable(
            f"its layer reaches up to {layer[-1, 0]:g} m, and the air to {atmosphere.thickness:g} m", ".ozone"
        )
    column = np.trapezoid(layer[:, 1], layer[:, 0])
    cross_section = media_presets.ozone_cross_section(within.grid())
    absorption = dobson_units * media_presets.dobson_unit() / column * cross_section
    substance = Substance(
        spectra.at_grid(absorption, within, zero_outside=False),
        _NOTHING,
        scene_pb2.PhaseFunction(henyey_greenstein=scene_pb2.HenyeyGreenstein(g=0.0)),
    )
    density = scene_pb2.AltitudeDensity()
    density.CopyFrom(ground)
    density.table.altitudes.extend(layer[:, 0].tolist())
    density.table.densities.extend(layer[:, 1].tolist())
    return media.add(substance, density)


def _exponential(ground: scene_pb2.AltitudeDensity, scale_height: float) -> scene_pb2.AltitudeDensity:
    density = scene_pb2.AltitudeDensity(scale_height=scale_height)
    density.MergeFrom(ground)
    return density


def _centre(atmosphere: Atmosphere) -> NDArray[np.float64]:
    return -(atmosphere.planet_radius + atmosphere.altitude) * unit(np.array(atmosphere.up))
