"""Sections of a report that are tables."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from nocturne_client.contract import Glare
from nocturne_client.local.report.contents import Section, Table, between, with_half
from nocturne_client.local.report.grid_values import GridValues
from nocturne_client.local.report.scene_parts import Lamp, Material
from nocturne_client.local.report.year import year_drawings
from nocturne_client.readings import rounded

_MEASURES = {
    "plane": "plane",
    "cylindrical": "cylindrical",
    "semicylindrical": "semicylindrical",
    "hemispherical": "hemispherical",
    "spherical": "spherical",
    "fluence": "fluence rate",
}


def readings_section(grids: Sequence[GridValues]) -> Section:
    """A row for each instrument."""
    has_factor = any(grid.daylight for grid in grids)
    has_colour = any(grid.colour for grid in grids)
    head = ["instrument", "measures", "values", "Em, lx", "Emin, lx", "Emax, lx", "U0"]
    head += ["DF mean, %", "DF min, %"] if has_factor else []
    head += ["CCT, K", "Ra"] if has_colour else []
    rows, notes = [], []
    for grid in grids:
        measured, low, u0 = grid.measured, grid.least, grid.u0
        row = [
            grid.part.name,
            _MEASURES.get(grid.part.measures, grid.part.measures),
            f"{grid.values.size}",
            with_half(measured.mean, measured.mean_error),
            "-" if low is None else f"{_lux(low.value)} ({_lux(low.low)} to {_lux(low.high)})",
            with_half(*_largest(grid)),
            "-" if u0 is None else between(u0.value, u0.low, u0.high, 2),
        ]
        if has_factor:
            factor = grid.daylight
            row += (
                ["-", "-"]
                if factor is None
                else [
                    with_half(factor.mean, factor.mean_error, 3),
                    with_half(factor.minimum, factor.minimum_error, 3),
                ]
            )
        if has_colour:
            colours = {each.name: each for each in grid.colour}
            for key in ("correlated colour temperature", "Ra"):
                each = colours.get(key)
                row.append("-" if each is None else with_half(each.value, each.error, 4))
        rows.append(row)
        if grid.unseen:
            notes.append(
                f"{grid.part.name}: {grid.unseen} meters have seen no light yet; their least value is open."
            )
    return Section("Points", tables=[Table(head, rows, texts=2)], notes=notes)


def _largest(grid: GridValues) -> tuple[float, float]:
    at = np.unravel_index(np.argmax(np.nan_to_num(grid.values)), grid.values.shape)
    return float(grid.values[at]), float(grid.errors[at])


def _lux(value: float) -> str:
    return rounded(value, 4 if abs(value) >= 100 else 3)


def glare_section(glares: Sequence[tuple[str, Glare]]) -> Section:
    """A row for each eye."""
    head = ("eye", "UGR", "DGP", "vertical, lx", "background, cd/m²", "sources")
    rows, notes = [], []
    for name, glare in glares:
        rows.append(
            (
                name,
                "not known" if glare.ugr is None else with_half(glare.ugr, glare.ugr_error, 3),
                with_half(glare.dgp, glare.dgp_error, 3),
                with_half(glare.vertical_illuminance, glare.vertical_illuminance_error),
                rounded(glare.background_luminance, 3),
                f"{len(glare.sources)}",
            )
        )
        notes += [f"{name}: {note}" for note in glare.notes]
    return Section("Glare", tables=[Table(head, rows)], notes=notes)


_FIGURES = {
    "DA": ("daylight autonomy", 100.0, "%"),
    "cDA": ("continuous daylight autonomy", 100.0, "%"),
    "UDI below": ("UDI, below 100 lx", 100.0, "%"),
    "UDI supplementary": ("UDI, 100 to 300 lx", 100.0, "%"),
    "UDI autonomous": ("UDI, 300 to 3000 lx", 100.0, "%"),
    "UDI above": ("UDI, above 3000 lx", 100.0, "%"),
    "sun hours": ("hours of more than 1000 lx of Sun", 1.0, "h"),
    "mean illuminance": ("mean illuminance", 1.0, "lx"),
}


def annual_section(annual: Mapping[str, Any]) -> Section:
    """Of what `nocturne annual` wrote."""
    rows = []
    for name, key in (("sDA300,50%", "sDA"), ("ASE1000,250h", "ASE")):
        share = annual[key]
        low, high = 100 * share["low"], 100 * share["high"]
        rows.append((f"{name}, of the points", f"{100 * share['value']:.1f} %", f"{low:.1f} to {high:.1f} %"))
    for name, (told, factor, unit) in _FIGURES.items():
        each = annual["means"].get(name)
        if each is not None:
            low, high = (rounded(factor * each[end], 4) for end in ("low", "high"))
            value = rounded(factor * each["value"], 4)
            rows.append((f"{told}, mean of the points", f"{value} {unit}", f"{low} to {high} {unit}"))
    said = [f"P({each['says']}) = {each['probability']:.3f}." for each in annual.get("verdicts", ())]
    place = f"{annual.get('weather', '')}; {annual.get('hours', 0)} hours"
    table = Table(("figure", "value", "95 % interval"), rows)
    return Section(
        "A year of daylight", [place, " ".join(said)], drawings=year_drawings(annual), tables=[table]
    )


def lamp_section(lamps: Sequence[Lamp]) -> Section:
    """Luminaires, their light and its maintenance."""
    if not lamps:
        return Section("Luminaires", ["The scene has no luminaires on surfaces."])
    head = ("luminaire", "count", "lm each", "maintenance factor", "dimming", "lm in use")
    rows = [
        (
            each.name,
            f"{each.count}",
            "-" if each.lumens is None else rounded(each.lumens, 5),
            f"{each.maintenance_factor:g}",
            f"{each.dimming:g}",
            "-" if each.used is None else rounded(each.used, 5),
        )
        for each in lamps
    ]
    if all(each.maintenance_factor == 1.0 for each in lamps):
        note = "No maintenance factor is given: values are those of a new installation."
    else:
        note = (
            "Values are maintained ones: the light of each luminaire is multiplied by its maintenance factor."
        )
    return Section("Luminaires", tables=[Table(head, rows)], notes=[note])


def material_section(materials: Sequence[Material]) -> Section:
    """What surfaces are made of."""
    rows = [
        (
            each.name,
            each.kind,
            "-" if each.reflectance is None else f"{each.reflectance:.3f}",
            f"{each.surfaces}",
        )
        for each in materials
    ]
    table = Table(("material", "kind", "reflectance (D65)", "surfaces"), rows, texts=2)
    return Section("Materials", tables=[table])
