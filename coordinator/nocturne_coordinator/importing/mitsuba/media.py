"""Participating media inside and outside of shapes."""

from nocturne_coordinator.importing.mitsuba.context import Context
from nocturne_coordinator.importing.mitsuba.properties import Properties
from nocturne_coordinator.importing.scene_writer import Json


def interior(context: Context, properties: Properties, surface: Json) -> None:
    """Put what a shape encloses into its surface."""
    del surface
    for medium in properties.take_all("medium"):
        context.findings.lost(medium.place, f'no equal of the medium "{medium.type}"; taken as empty space')
