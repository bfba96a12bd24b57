"""Media, and the interiors that they fill, as messages.

Long: each kind of medium, of density and of phase function is a few lines, and they share one state.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.fluorescence import Dyes, compile_dyes
from nocturne_scene.compile.grids import Grids
from nocturne_scene.compile.indices import compile_index
from nocturne_scene.compile.polarisation import asks_for_polarisation
from nocturne_scene.compile.sensors import unit, vector
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.fluorescence import Dye
from nocturne_scene.document.media import (
    AbovePlane,
    AboveSphere,
    DoubleHenyeyGreensteinPhase,
    Droplets,
    ExponentialDensity,
    Grid,
    HenyeyGreensteinPhase,
    IsotropicPhase,
    LayeredDensity,
    Medium,
    MiePhase,
    Phase,
    RayleighPhase,
    ScatteringMatrix,
    TabulatedPhase,
)
from nocturne_scene.document.medium_interfaces import Interior
from nocturne_scene.document.problems import path
from nocturne_scene.media import mie, rayleigh
from nocturne_scene.media import presets as media_presets
from nocturne_scene.meshes.similarity import Similarity
from nocturne_scene.spectra import indices
from nocturne_scene.spectra.published import Floats


class Substance(NamedTuple):
    """What a medium does to light where its density is 1; 1/m."""

    absorption: scene_pb2.Spectrum
    scattering: scene_pb2.Spectrum
    phase: scene_pb2.PhaseFunction
    dyes: Dyes | None = None
    """Their absorption is part of the absorption."""

    @property
    def is_nothing(self) -> bool:
        """Whether light does not notice it."""
        return spectra.is_black(self.absorption) and spectra.is_black(self.scattering)

    def scaled(self, factor: float) -> "Substance":
        """Return it with `factor` times the density; it may hold no dyes."""
        return self._replace(
            absorption=spectra.scaled_evenly(self.absorption, factor),
            scattering=spectra.scaled_evenly(self.scattering, factor),
        )


class Media:
    """Compiles media, each named one once, and interiors."""

    def __init__(self, workspace: Workspace, grids: Grids) -> None:
        self._workspace = workspace
        self._grids = grids
        self._polarised = asks_for_polarisation(workspace.document)
        self._named: dict[str, int | None] = {}
        self.messages: list[scene_pb2.Medium] = []
        """In order of first use; equal ones stay apart, as their densities add up."""

    def scatters(self) -> bool:
        """Whether any compiled medium sends light on."""
        pool = self._workspace.spectra.messages
        return any(not spectra.is_black(pool[medium.scattering]) for medium in self.messages)

    def interior(self, interior: Interior | None, body: scene_pb2.Interior | None, place: str) -> int | None:
        """Return the index of the interior of a surface.

        `body` is what a dielectric kernel encloses, None with other kernels. None: nothing is inside.
        """
        if interior is None:
            return None if body is None else self._workspace.interiors.index_of(body)
        if body is not None and body.HasField("outside"):
            with self._workspace.problems_at(place):
                raise Unusable("the dielectric kernel with its index outside bounds no body; leave this out")
        if body is not None and interior.priority is not None:
            with self._workspace.problems_at(f"{place}.priority"):
                raise Unusable("the dielectric kernel has a priority of its own; leave this one out")
        message = scene_pb2.Interior(index_matched=True, priority=interior.priority or 0)
        if body is not None:
            message.CopyFrom(body)
        names = list(interior.media)
        if body is not None:
            names = self._absorbed(names, message)
        self._fill(message, names)
        if message.index_matched and not message.media:
            return None
        return self._workspace.interiors.index_of(message)

    def unbounded(self) -> list[int]:
        """Return the indices of interiors that are everywhere."""
        message = scene_pb2.Interior(index_matched=True, priority=-bounds.PRIORITY)
        self._fill(message, self._workspace.document.unbounded_media)
        return [self._workspace.interiors.index_of(message)] if message.media else []

    def add(self, substance: Substance, density: scene_pb2.AltitudeDensity) -> int:
        """Add a medium whose density depends on altitude; returns its index."""
        message = self._message(substance)
        message.altitude.CopyFrom(density)
        return self._add(message)

    def substance(self, name: str) -> Substance:
        """Return what a named medium is made of; raises Unusable."""
        self._workspace.use("media", name)
        medium = self._workspace.document.media[name]
        if medium.droplets is not None:
            with _inside(".droplets"):
                return self._droplets(medium.droplets)
        if medium.preset is not None:
            return self._preset(medium.preset)
        plain = Substance(
            self._coefficient(medium.absorption),
            self._coefficient(medium.scattering),
            self._phase(medium.phase),
        )
        return self._dyed(plain, medium.fluorescence) if medium.fluorescence else plain

    def _dyed(self, plain: Substance, fluorescence: list[Dye]) -> Substance:
        grid = self._workspace.spectral.grid()
        absorption, scattering = (
            spectra.evaluate(each, grid) for each in (plain.absorption, plain.scattering)
        )
        dyes = compile_dyes(self._workspace, fluorescence, absorption + scattering)
        return plain._replace(absorption=self._at_grid(absorption + dyes.absorption), dyes=dyes)

    def _at_grid(self, values: Floats) -> scene_pb2.Spectrum:
        return spectra.at_grid(values, self._workspace.spectral, zero_outside=False)

    def _fill(self, message: scene_pb2.Interior, names: Sequence[str]) -> None:
        found = (self._index(name) for name in names)
        message.media.extend(index for index in found if index is not None)

    def _absorbed(self, names: list[str], body: scene_pb2.Interior) -> list[str]:
        """Turn a medium that only absorbs, evenly, into the body's own absorption: the same without chance.

        Returns the names that are left.
        """
        for name in names:
            medium = self._workspace.document.media[name]
            if body.HasField("absorption") or medium.temperature is not None or medium.fluorescence:
                continue
            if not isinstance(medium.density, int | float) or medium.density == 0:
                continue
            with self._workspace.problems_at(path(("media", name))):
                substance = self.substance(name).scaled(medium.density)
                if spectra.is_black(substance.scattering) and not substance.is_nothing:
                    body.absorption = self._workspace.spectra.index_of(substance.absorption)
                    return [other for other in names if other != name]
        return names

    def _index(self, name: str) -> int | None:
        """The index of a medium; None if it is nothing, or can't be compiled, which is noted."""
        if name not in self._named:
            self._named[name] = None
            with self._workspace.problems_at(path(("media", name))):
                self._named[name] = self._compile(name)
        return self._named[name]

    def _compile(self, name: str) -> int | None:
        medium = self._workspace.document.media[name]
        substance = self.substance(name)
        if substance.is_nothing or medium.density == 0:
            reason = (
                "has no density"
                if medium.density == 0
                else f"neither absorbs nor scatters {self._workspace.light}"
            )
            self._workspace.dropped.append(f"{path(('media', name))}: {reason}")
            return None
        match medium.density:
            case Grid() as grid:
                message = self._message(substance)
                with _inside(".density"):
                    message.grid.CopyFrom(self._grids.density(grid))
            case ExponentialDensity() as profile:
                if substance.dyes is not None:
                    raise Unusable("a medium that fluoresces has another density", ".density")
                message = self._message(substance.scaled(profile.at_ground))
                message.altitude.CopyFrom(above(profile.above, self._workspace.frame))
                message.altitude.scale_height = profile.scale_height
            case LayeredDensity() as profile:
                message = self._message(substance)
                message.altitude.CopyFrom(above(profile.above, self._workspace.frame))
                message.altitude.table.altitudes.extend(altitude for altitude, _ in profile.layers)
                message.altitude.table.densities.extend(density for _, density in profile.layers)
            case density:
                message = self._message(substance)
                message.constant = density
        self._put_glow(message, medium)
        return self._add(message)

    def _put_glow(self, message: scene_pb2.Medium, medium: Medium) -> None:
        if medium.temperature is None or medium.emission_scale == 0:
            return
        if spectra.is_black(self._workspace.spectra.messages[message.absorption]):
            raise Unusable("glows only where it absorbs, and it does not", ".temperature")
        with _inside(".temperature"):
            message.temperature.CopyFrom(self._grids.density(medium.temperature))
        message.emission_scale = 1.0 if medium.emission_scale is None else medium.emission_scale

    def _message(self, substance: Substance) -> scene_pb2.Medium:
        index_of = self._workspace.spectra.index_of
        for spectrum in (substance.absorption, substance.scattering):
            if not np.all(np.isfinite(spectrum.values)):
                raise Unusable("a coefficient is too large for a 32-bit number")
        message = scene_pb2.Medium(
            absorption=index_of(substance.absorption),
            scattering=index_of(substance.scattering),
            phase=substance.phase,
        )
        if substance.dyes is not None:
            message.fluorophores.extend(substance.dyes.fluorophores)
            message.null_collisions = index_of(self._at_grid(substance.dyes.null_collisions))
        return message

    def _add(self, message: scene_pb2.Medium) -> int:
        self.messages.append(message)
        return len(self.messages) - 1

    def _coefficient(self, reference: object) -> scene_pb2.Spectrum:
        if reference is None:
            return scene_pb2.Spectrum(values=[0.0])
        spectrum = self._workspace.spectrum(reference)  # type: ignore[arg-type]
        return spectra.reflectance(spectrum, self._workspace.spectral)

    def _preset(self, name: str) -> Substance:
        distributions = media_presets.droplets()
        if name in distributions:
            return self._droplets(Droplets(**distributions[name]))
        within = self._workspace.spectral
        coefficients = media_presets.coefficients(name, within)
        phase = scene_pb2.PhaseFunction(henyey_greenstein=scene_pb2.HenyeyGreenstein(g=0.0))
        if name == media_presets.AIR:
            phase = self.air_phase()
        return Substance(
            spectra.at_grid(coefficients.absorption, within, zero_outside=False),
            spectra.at_grid(coefficients.scattering, within, zero_outside=False),
            phase,
        )

    def air_phase(self) -> scene_pb2.PhaseFunction:
        """Return how clean air scatters."""
        within = self._workspace.spectral
        ratio = spectra.at_grid(rayleigh.depolarisation(within.grid()), within, zero_outside=False)
        index = self._workspace.spectra.index_of(ratio)
        return scene_pb2.PhaseFunction(rayleigh=scene_pb2.RayleighPhase(depolarisation=index))

    def _droplets(self, droplets: Droplets) -> Substance:
        scattering = self._mie(droplets)
        within = self._workspace.spectral
        at, values = mie.wavelengths(within), droplets.number * scattering.cross_section
        phase = _mie_phase(scattering, at)
        if not within.is_usual:
            at, values = within.grid(), np.interp(within.grid(), at, values)
        spectrum = scene_pb2.Spectrum(
            first_nm=float(at[0]), step_nm=float(at[1] - at[0]), values=values.astype(np.float32).tolist()
        )
        return Substance(scene_pb2.Spectrum(values=[0.0]), spectrum, phase)

    def _mie(self, droplets: Droplets) -> mie.Scattering:
        try:
            index = compile_index(self._workspace, droplets.index)
        except indices.BadIndexError as error:
            raise Unusable(str(error), ".index") from None
        within = self._workspace.spectral
        values = spectra.evaluate(self._workspace.spectra.messages[index], mie.wavelengths(within))
        distribution = mie.Distribution(droplets.mode_radius, droplets.alpha, droplets.gamma)
        try:
            return mie.scattering(distribution, tuple(values.tolist()), within, polarised=self._polarised)
        except mie.TooLargeError as error:
            raise Unusable(str(error), ".mode_radius") from None

    def _phase(self, phase: Phase | None) -> scene_pb2.PhaseFunction:
        match phase:
            case None | IsotropicPhase():
                return scene_pb2.PhaseFunction(henyey_greenstein=scene_pb2.HenyeyGreenstein(g=0.0))
            case HenyeyGreensteinPhase():
                return scene_pb2.PhaseFunction(henyey_greenstein=scene_pb2.HenyeyGreenstein(g=phase.g))
            case DoubleHenyeyGreensteinPhase():
                double = scene_pb2.DoubleHenyeyGreenstein(
                    g_first=phase.first, g_second=phase.second, weight=phase.weight
                )
                return scene_pb2.PhaseFunction(double_henyey_greenstein=double)
            case RayleighPhase():
                rayleigh_phase = scene_pb2.RayleighPhase()
                ratio = self._coefficient(phase.depolarisation)
                if not spectra.is_black(ratio):
                    rayleigh_phase.depolarisation = self._workspace.spectra.index_of(ratio)
                return scene_pb2.PhaseFunction(rayleigh=rayleigh_phase)
            case TabulatedPhase():
                table = scene_pb2.TabulatedPhase(wavelengths=phase.wavelengths, cosines=phase.cosines)
                for row in phase.values:
                    table.values.extend(row)
                if self._polarised and phase.matrix is not None:
                    _put_matrix(table, phase.matrix)
                return scene_pb2.PhaseFunction(tabulated=table)
            case MiePhase():
                with _inside(".phase.droplets"):
                    return _mie_phase(self._mie(phase.droplets), mie.wavelengths(self._workspace.spectral))


def _mie_phase(scattering: mie.Scattering, at: Floats) -> scene_pb2.PhaseFunction:
    table = scene_pb2.TabulatedPhase(
        wavelengths=at.tolist(),
        cosines=scattering.cosines.tolist(),
        values=scattering.phase.astype(np.float32).ravel().tolist(),
    )
    if scattering.matrix is not None:
        for name, element in zip(("s12", "s33", "s34"), scattering.matrix, strict=True):
            getattr(table, name).extend(np.clip(element, -1.0, 1.0).astype(np.float32).ravel().tolist())
    return scene_pb2.PhaseFunction(tabulated=table)


def _put_matrix(table: scene_pb2.TabulatedPhase, matrix: ScatteringMatrix) -> None:
    for name in ("s12", "s22", "s33", "s34", "s44"):
        for row in getattr(matrix, name) or []:
            getattr(table, name).extend(row)


@contextmanager
def _inside(field: str) -> Iterator[None]:
    """Problems in the block are those of a field."""
    try:
        yield
    except Unusable as error:
        raise Unusable(str(error), field + error.suffix) from None


def above(ground: AbovePlane | AboveSphere, frame: Similarity) -> scene_pb2.AltitudeDensity:
    """Return a density without its profile."""
    if isinstance(ground, AboveSphere):
        return above_sphere(np.array(ground.centre), ground.radius, frame)
    base = frame.points(np.array(ground.point))
    return scene_pb2.AltitudeDensity(base=vector(base), up=vector(unit(np.array(ground.up))))


def above_sphere(centre: Floats, radius: float, frame: Similarity) -> scene_pb2.AltitudeDensity:
    """Return the same, from the point of the ground that is below the compiled scene's origin."""
    centre = frame.points(centre)
    up = -unit(centre) if np.any(centre) else np.array([0.0, 1.0, 0.0])
    return scene_pb2.AltitudeDensity(base=vector(centre + radius * up), up=vector(up), radius=radius)
