"""Participating media of pbrt's."""

from nocturne_coordinator.importing.pbrt.context import Context
from nocturne_coordinator.importing.pbrt.parameters import Parameters
from nocturne_coordinator.importing.scene_writer import Json


def add_medium(context: Context, name: str, parameters: Parameters) -> None:
    """A `MakeNamedMedium` directive."""
    context.findings.lost(parameters.place, f'no equal of the medium "{name}"; taken as empty space')


def interior(context: Context, place: str, surface: Json) -> None:
    """Put what a shape encloses into its surface."""
    del context, place, surface
