"""A year of daylight as plain values, in one spelling for all who tell it."""

import json
from typing import Any

from nocturne_scene.daylight.metrics import Estimate, Share
from nocturne_scene.daylight.year_of_light import YearOfLight

UNITS = {
    "hours above": "h",
    "sun hours": "h",
    "mean illuminance": "lx",
    "lux hours of the year": "lx h",
    "melanopic EDI": "lx",
}
"""Of figures; all others are parts of the hours."""


def as_json(found: YearOfLight) -> dict[str, Any]:
    """All of it; `hourly` is the mean over the points of each hour of the year, lx."""
    place = found.year.place
    return {
        "weather": found.year.name,
        "latitude": place.latitude,
        "longitude": place.longitude,
        "hours": found.hours,
        "batches": found.batches,
        "samples": found.samples,
        **({} if found.blinds_closed is None else {"blinds closed": _number(found.blinds_closed)}),
        "sDA": {**_share(found.sda), "probabilities": [_number(each) for each in found.sda.probabilities]},
        "ASE": _share(found.ase),
        **{name: _share(each) for name, each in found.provision.items()},
        "verdicts": [{"says": said, "probability": _number(chance)} for said, chance in found.verdicts()],
        "hourly": [float(f"{each:.4g}") for each in found.hourly.value],
        "means": {name: _estimate(each) for name, each in found.means.items()},
        "points": [
            {
                "instrument": found.points.names[i],
                "place": found.points.places[i].tolist(),
                **{
                    name: _estimate(Estimate(each.value[i], each.error[i], each.degrees))
                    for name, each in found.by_point.items()
                },
            }
            for i in range(len(found.points.names))
        ],
        "eyes": [
            {
                "instrument": found.points.names[i],
                "place": found.points.places[i].tolist(),
                **{
                    name: _estimate(Estimate(each.value[at], each.error[at], each.degrees))
                    for name, each in found.of_eyes.items()
                },
            }
            for at, i in enumerate(found.eyes)
        ],
    }


def _number(value: Any) -> float:
    """Nine digits are more than any figure has; the last of sixteen depend on how a machine adds up."""
    return float(f"{float(value):.9g}")


def _share(share: Share) -> dict[str, float]:
    return {"value": _number(share.value), "low": _number(share.low), "high": _number(share.high)}


def _estimate(each: Estimate) -> dict[str, Any]:
    low, high = each.interval()
    return {"value": _number(each.value), "low": _number(low), "high": _number(high)}


def as_text(found: YearOfLight) -> str:
    """The same as JSON."""
    return json.dumps(as_json(found), indent=1) + "\n"
