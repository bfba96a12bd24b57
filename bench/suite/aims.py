"""Aims of the comparison with the peer, and why some are not reached."""

from bench.report import Figures
from bench.suite.measure import MITSUBA

_EQUAL, _TENTH = 1.0, 0.1

AIMS = {
    "cornell": _EQUAL,
    "glossy spheres": _EQUAL,
    "reflector": _TENTH,
    "headlight in fog": _TENTH,
    "smoke": _EQUAL,
    "sky": _EQUAL,
    "subsurface": _EQUAL,
    "prism": _TENTH,
    "caustic": _TENTH,
    "colour chart": _EQUAL,
    "instances": _EQUAL,
}
"""Error over that of the peer's best variant at equal CPU time."""

WHY = {
    "cornell": "Mitsuba's vectorised variant has less error in the same time, its scalar one about as "
    "much as ours. Two fifths of our time are Embree's search by single rays, and a sixth of all is what "
    "it costs that this is watertight, as Mitsuba's is on request only (embree_use_robust_intersections).",
    "glossy spheres": "no reason was looked for.",
    "reflector": "Mitsuba's particle tracer starts at the lamp, too. Both draw photons alike, and each pixel "
    "gets few of them.",
    "headlight in fog": "Mitsuba finds only the light that misses the fog, so nothing is there to compare "
    "with. Both directions converge; each pixel outside of the beam is lit by few photons.",
    "smoke": "no reason was looked for.",
    "sky": "Mitsuba has no panoramic camera, and the air of a planet can't be exported: its rays meet "
    "spheres of 6,371 km too inexactly for shells of air ([compatibility](../reference/compatibility.md)).",
    "subsurface": "walks of very many collisions decide, and with photons in groups each of them is dearer.",
    "prism": "Mitsuba has no index of refraction that depends on wavelength, and no luminaire whose radiance "
    "depends on direction.",
    "caustic": "no reason was looked for.",
    "colour chart": "no reason was looked for.",
    "instances": "no reason was looked for.",
}
"""Reasons for scenes whose aim is missed, or that the peer can't render."""

_BASELINES = ("path", "march")


def best(ways: Figures, *, peers: bool) -> str | None:
    """The method with the least error at the longest time; None if no method has one.

    A method whose mean is off by more than five standard errors missed light, and is left out: its small
    error means nothing.
    """
    found = {
        name: way["error"]
        for name, way in ways.items()
        if name.startswith(MITSUBA) == peers
        and name not in _BASELINES
        and "error" in way
        and abs(way["points"][-1]["z"]) < 5.0
        and not way["points"][-1]["not_finite"]
    }
    return min(found, key=lambda name: found[name], default=None)
