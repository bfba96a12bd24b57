"""What emits: luminaires on surfaces, the environment, discs at infinity; and important directions."""

import math
from collections.abc import Callable

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.environment import compile_map, compile_sky, sun_of_sky
from nocturne_scene.compile.photometry import compile_profile, flux_behind, spectrum_of
from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.sensors import unit, vector
from nocturne_scene.compile.shapes import Shapes, put_shape
from nocturne_scene.compile.textures import Textures
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.light_fields import HiddenFrom
from nocturne_scene.document.luminaires import (
    ConstantEnvironment,
    CosineProfile,
    DistantDisc,
    Luminaire,
    PhotometricProfile,
)
from nocturne_scene.document.problems import path
from nocturne_scene.document.sensors import CAMERAS
from nocturne_scene.document.shapes import Sphere
from nocturne_scene.document.skies import StandardSky, WeatherSky
from nocturne_scene.document.spectrum_checks import Reference
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.document.textures import ColourTexture
from nocturne_scene.meshes.triangles import area_vectors
from nocturne_scene.spectra import sun

_LOST = 1e-3
"""Part of a photometric file's light that may go to the back of a lamp without being told."""


def _of_luminance(
    luminance_of: Callable[[scene_pb2.Spectrum], float],
) -> Callable[[scene_pb2.Spectrum], scene_pb2.Spectrum]:
    """What gives a spectrum the luminance, cd/m2, that follows from it at 1 cd/m2."""

    def scaled(spectrum: scene_pb2.Spectrum) -> scene_pb2.Spectrum:
        at_one = spectra.scaled_to_luminance(spectrum, 1.0)
        return spectra.scaled_to_luminance(at_one, luminance_of(at_one))

    return scaled


class Lights:
    """Compiles everything that emits."""

    def __init__(self, workspace: Workspace, textures: Textures, shapes: Shapes) -> None:
        self._workspace = workspace
        self._textures = textures
        self._shapes = shapes

    def luminaire(self, surface: Surface, index: int, place: str) -> scene_pb2.Luminaire | None:
        """Return the luminaire of surface number `index`; None if it has none, or one that emits nothing."""
        luminaire = surface.luminaire
        if luminaire is None:
            return None
        message = scene_pb2.Luminaire(surface=index, two_sided=luminaire.two_sided)
        with self._workspace.problems_at(f"{place}.luminaire"):
            amount = self._amount(surface, luminaire)
            radiance, at = self._radiance(luminaire)
            colour = self._textures.radiance(radiance, at, amount=amount, part=luminaire.part_emitted)
            self._report_lines(radiance, f"{place}.luminaire{at}")
            if colour is None:
                self._workspace.dropped.append(f"{place}.luminaire: emits no {self._workspace.light}")
                return None
            if colour.HasField("texture"):
                self._photons_cant_start()
            message.radiance.CopyFrom(colour)
            message.hidden_from = self._hidden_from(luminaire.hidden_from)
            message.light_group = self._workspace.light_groups.number(luminaire.light_group)
            self._put_profile(message, surface, luminaire)
            self._tell_of_lost_light(message, surface, place)
            return message
        return None

    def _radiance(self, luminaire: Luminaire) -> tuple[Reference | ColourTexture, str]:
        """And where it stands: in a photometric file where the document leaves it out."""
        if luminaire.radiance is not None:
            return luminaire.radiance, ".radiance"
        assert isinstance(luminaire.profile, PhotometricProfile)  # noqa: S101 - the document was checked
        return spectrum_of(self._workspace, luminaire.profile), ".profile.asset"

    def _photons_cant_start(self) -> None:
        direction = self._workspace.document.tracing.direction
        if direction in ("forward", "both"):
            raise Unusable(
                'photons that start at luminaires can\'t start by a texture; expected "adjoint" in '
                "$.tracing.direction, or a radiance without a texture",
                ".radiance",
            )
        self._workspace.photons_can_start = False

    def _amount(
        self, surface: Surface, luminaire: Luminaire
    ) -> Callable[[scene_pb2.Spectrum], scene_pb2.Spectrum] | None:
        """What gives a luminaire's spectrum the radiance at normal incidence that its flux or exitance comes
        to; None: its radiance says it."""
        if isinstance(luminaire.profile, PhotometricProfile):
            return _of_luminance(lambda _: 1.0)
        power = luminaire.profile.cosine_power if isinstance(luminaire.profile, CosineProfile) else 0.0
        # Exitance over luminance: the integral of cos^(power + 1) over the hemisphere.
        factor = 2 * math.pi / (power + 2)
        if luminaire.exitance is not None:
            from_exitance = luminaire.exitance / factor
            return _of_luminance(lambda _: from_exitance)
        flux = luminaire.lumens or luminaire.watts
        if flux is None:
            return None
        area = self._shapes.area(surface.shape) * surface.scale**2 * (2 if luminaire.two_sided else 1)
        per_unit = flux / (factor * area)
        if luminaire.watts is None:
            return _of_luminance(lambda _: per_unit)
        within = self._workspace.wavelengths
        if not within.is_usual:
            return lambda spectrum: spectra.scaled_to_integral(spectrum, per_unit, within)
        ones = np.ones(len(within.grid()))
        return _of_luminance(lambda spectrum: per_unit / float(spectra.integral(spectrum, ones)))

    def _put_profile(self, message: scene_pb2.Luminaire, surface: Surface, luminaire: Luminaire) -> None:
        match luminaire.profile:
            case CosineProfile() as profile:
                message.cosine_power = profile.cosine_power
            case PhotometricProfile() as profile:
                if message.radiance.HasField("texture"):
                    raise Unusable("can't have a texture together with a photometric file", ".radiance")
                if not (isinstance(surface.shape, Sphere) or self._shapes.is_flat(surface.shape)):
                    raise Unusable(
                        "a photometric file needs a flat shape or a sphere: a quad, a disc, a flat mesh, "
                        "a sphere",
                        ".profile",
                    )
                placement = placement_of(surface)
                axis = placement.turned(unit(np.array(profile.axis)))
                zero = placement.turned(np.array(profile.zero))
                zero = unit(zero - (zero @ axis) * axis)
                message.intensity.CopyFrom(compile_profile(self._workspace, profile))
                # Straight down, plane C0, and to the right of that.
                frame = np.column_stack([axis, zero, np.cross(axis, zero)])
                for told in (message.intensity.axis, message.intensity.zero):
                    told.CopyFrom(vector(frame @ np.array([told.x, told.y, told.z])))

    def _tell_of_lost_light(self, message: scene_pb2.Luminaire, surface: Surface, place: str) -> None:
        """Warn of a file's light on the side of a flat lamp that does not emit."""
        if not message.HasField("intensity") or message.two_sided or isinstance(surface.shape, Sphere):
            return
        mesh = self._shapes.triangles(surface.shape)
        normal = area_vectors(placement_of(surface).points(mesh.vertices[mesh.indices])).sum(axis=0)
        lost, total = flux_behind(message.intensity, normal)
        if lost > _LOST * total:
            told = (
                f"{place}.luminaire.profile: of the file's {total:.4g} lm, {lost:.4g} lm go to the back of "
                "the surface, which does not emit, and are lost; turn its normal or the profile's axis, or "
                "set two_sided"
            )
            # Once for all places where instances show it.
            if told not in self._workspace.warnings:
                self._workspace.warnings.append(told)

    def environment(self) -> scene_pb2.Environment | None:
        """Return the environment; None if there is none, or if it is black."""
        environment = self._workspace.document.environment
        if environment is None:
            return None
        with self._workspace.problems_at("$.environment"):
            hidden = self._hidden_from(environment.hidden_from)
            light_group = self._workspace.light_groups.number(environment.light_group)
            if isinstance(environment, StandardSky | WeatherSky):
                sky = compile_sky(self._workspace, environment)
                return scene_pb2.Environment(map=sky, hidden_from=hidden, light_group=light_group)
            if not isinstance(environment, ConstantEnvironment):
                picture = compile_map(self._workspace, environment)
                return scene_pb2.Environment(map=picture, hidden_from=hidden, light_group=light_group)
            radiance = self._emission(environment.radiance, ".radiance")
            self._report_lines(environment.radiance, "$.environment.radiance")
            if radiance is not None:
                return scene_pb2.Environment(constant=radiance, hidden_from=hidden, light_group=light_group)
            self._workspace.dropped.append(f"$.environment: emits no {self._workspace.light}")
        return None

    def distant_discs(self) -> list[scene_pb2.DistantDisc]:
        """Return the discs at infinity that emit."""
        found = []
        for number, disc in enumerate(self._workspace.document.distant):
            place = path(("distant", number))
            with self._workspace.problems_at(place):
                message = self._disc(disc)
                self._report_lines(disc.radiance, f"{place}.radiance")
                self._report_lines(disc.irradiance, f"{place}.irradiance")
                if message is None:
                    self._workspace.dropped.append(f"{place}: emits no {self._workspace.light}")
                else:
                    found.append(message)
        sky = self._workspace.document.environment
        if isinstance(sky, StandardSky | WeatherSky):
            with self._workspace.problems_at("$.environment"):
                disc_of_sky = sun_of_sky(self._workspace, sky)
                if disc_of_sky is not None:
                    disc_of_sky.hidden_from = self._hidden_from(sky.hidden_from)
                    disc_of_sky.light_group = self._workspace.light_groups.number(sky.light_group)
                    found.append(disc_of_sky)
        return found

    def important_shapes(self) -> list[scene_pb2.ImportantShape]:
        """Return the shapes that are worth looking at."""
        found = []
        for number, direction in enumerate(self._workspace.document.important_directions):
            place = path(("important_directions", number))
            if direction.weight == 0:
                self._workspace.dropped.append(f"{place}: has no weight")
                continue
            with self._workspace.problems_at(f"{place}.shape"):
                message = scene_pb2.ImportantShape(weight=direction.weight)
                steps = [self._workspace.frame.after(placement_of(direction))]
                put_shape(message, self._shapes.compile(direction.shape, steps, f"{place}.shape"))
                found.append(message)
        return found

    def _hidden_from(self, hidden: HiddenFrom) -> scene_pb2.HiddenFrom.ValueType:
        """Meters see every light."""
        if hidden is None or not isinstance(self._workspace.document.sensor, CAMERAS):
            return scene_pb2.HIDDEN_FROM_NOBODY
        if hidden == "camera":
            return scene_pb2.HIDDEN_FROM_CAMERA
        return scene_pb2.HIDDEN_FROM_CAMERA_AND_MIRRORS

    def _report_lines(self, reference: Reference | ColourTexture | None, place: str) -> None:
        if isinstance(reference, ColourTexture):
            reference, place = reference.spectrum, f"{place}.spectrum"
        self._workspace.report_unseen(reference, place)

    def _emission(self, reference: Reference, suffix: str) -> int | None:
        colour = self._textures.radiance(reference, suffix)
        return None if colour is None else colour.spectrum

    def _disc(self, disc: DistantDisc) -> scene_pb2.DistantDisc | None:
        size = disc.angular_diameter_degrees
        half_angle = sun.half_angle() if size is None else math.radians(size) / 2
        within = self._workspace.spectral
        limb = sun.sun(within=within) if disc.limb_darkening else sun.sun(darkened=False, within=within)
        if disc.radiance is not None:
            radiance = self._emission(disc.radiance, ".radiance")
        else:
            radiance = self._from_irradiance(disc, half_angle)
        if radiance is None:
            return None
        index_of = self._workspace.spectra.index_of
        return scene_pb2.DistantDisc(
            direction=vector(unit(np.array(disc.direction))),
            half_angle=half_angle,
            radiance=radiance,
            limb_plus=[index_of(spectrum) for spectrum in limb.limb_plus],
            limb_minus=[index_of(spectrum) for spectrum in limb.limb_minus],
            hidden_from=self._hidden_from(disc.hidden_from),
            light_group=self._workspace.light_groups.number(disc.light_group),
        )

    def _from_irradiance(self, disc: DistantDisc, half_angle: float) -> int | None:
        """Radiance at the centre of a disc from its irradiance, face on; the mean is E / (pi sin^2 a)."""
        within = self._workspace.spectral
        if disc.irradiance is None:
            irradiance = spectra.at_grid(sun.irradiance(within), within)
        else:
            irradiance = spectra.radiance(self._workspace.spectrum(disc.irradiance), within)
        grid = within.grid()
        factors = np.full(grid.shape, 1 / (math.pi * math.sin(half_angle) ** 2))
        if disc.limb_darkening:
            darkened = sun.sun(within=within).radiance
            even = spectra.evaluate(sun.sun(darkened=False, within=within).radiance, grid)
            lit = even > 0
            factors[lit] *= spectra.evaluate(darkened, grid)[lit] / even[lit]
        compiled = spectra.scaled(irradiance, factors, within)
        if self._workspace.is_dark(compiled):
            return None
        try:
            spectra.check_finite(compiled)
        except spectra.NotCompilableError as error:
            raise Unusable(str(error), ".irradiance") from None
        return self._workspace.spectra.index_of(compiled)
