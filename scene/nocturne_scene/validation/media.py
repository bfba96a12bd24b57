"""Slabs of media: van de Hulst's, Chandrasekhar's half spaces, slabs with a smooth surface (MCML's), air."""

from collections.abc import Iterator
from math import acos, cos, degrees, pi, radians, sin, sqrt

from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.documents import (
    Document,
    along,
    from_above,
    lit_slab,
    medium,
    sun,
)
from nocturne_scene.validation.truths import truths

_KEYS = ("R_normal", "T_normal", "R_60deg", "T_60deg", "R_diffuse", "T_diffuse")
_WORDS = {
    "R": "reflectance",
    "T": "transmittance",
    "normal": "0 deg",
    "60deg": "60 deg",
    "diffuse": "diffuse",
}
_DEEP = 60.0
"""Of a refracting half space: exp(-2 x 60 x 0.55) come back from below."""
_GIOVANELLI = " (R. G. Giovanelli, Optica Acta 2, 1955, as in MCML: 0.2600)"
_MCML = "; R and T along the normal are MCML's 0.09739 and 0.66096"
_FAINT = 4e-3


def scenes() -> Iterator[Scene]:
    """Total reflectances and transmittances include light that nothing scattered."""
    known = truths("media")
    for case in known["slabs"]["cases"]:
        source = "H. C. van de Hulst, Multiple Light Scattering, 1980, recalculated by adding-doubling"
        if case["g"] == 0.75 and case["thickness"] == 2.0 and case["albedo"] == 0.9:
            source += _MCML
        yield from _slab(case, source)
    for case in known["refracting slabs"]["cases"]:
        source = "adding-doubling with Fresnel's boundaries, checked against S. A. Prahl's package"
        source += _GIOVANELLI if case["thickness"] > 100.0 else ""
        yield from _slab(case, source, kernel={"type": "dielectric", "index": case["index"]})
    for case in known["half spaces"]["cases"]:
        # Diffusion length 1 / sqrt(3 (1 - albedo)): light fades to 1e-9.
        deep = 10.0 / sqrt(3.0 * (1.0 - case["albedo"])) + 5.0
        reflected = {"R_" + key[2:]: truth for key, truth in case.items() if key.startswith("A_")}
        yield from _slab({**case, **reflected, "thickness": deep}, known["half spaces"]["source"])
    yield from _by_direction(known["angular"])
    yield from _air(known["rayleigh layers"])


def _slab(case: Document, source: str, **more: object) -> Iterator[Scene]:
    thickness = min(case["thickness"], _DEEP) if more else case["thickness"]
    named = ", ".join(
        f"{key} {case[key]:.4g}" for key in ("albedo", "g", "thickness", "index") if key in case
    )
    for key in _KEYS:
        if case.get(key, 0.0) < _FAINT:
            continue
        which, light = key.split("_")
        diffuse = light == "diffuse"
        sensor = from_above(1e-3) if diffuse else along(60.0 if light == "60deg" else 0.0, 2.0)
        fog = medium(case["albedo"], case.get("g", 0.0))
        document = lit_slab(fog, thickness, sensor, below=which == "T", **more)
        name = f"{_WORDS[which]}, {_WORDS[light]}: {named}"
        yield Scene(document, (Value(name, case[key], source, factor=1.0 / pi if diffuse else 1.0),), 2**16)


def _by_direction(known: Document) -> Iterator[Scene]:
    for key, case in known["cases"].items():
        mu = float(key.removeprefix("mu="))
        for which, truth in (("R", case["R"]), ("T", case["T_diffuse"])):
            document = lit_slab(medium(0.9, 0.75), 2.0, along(degrees(acos(mu)), 2.0), below=True)
            del document["environment"], document["surfaces"][1]
            # A slab seen from below and lit from above is one seen from above and lit from below.
            document["distant"] = [sun(0.0 if which == "R" else 180.0)]
            name = f"radiance at mu {mu:g}, {_WORDS[which]}: albedo 0.9, g 0.75, thickness 2"
            yield Scene(document, (Value(name, truth, known["source"]),), 2**16)


def _air(known: Document) -> Iterator[Scene]:
    """Rayleigh's layers, seen from above in some directions."""
    for case in known["cases"]:
        for view, truth in list(case["up"].items())[::3]:
            mu, azimuth = (float(part) for part in view.split("/"))
            beside = sqrt(1.0 - mu * mu)
            travel = [beside * cos(radians(azimuth)), beside * sin(radians(azimuth)), mu]
            meter = {
                "type": "radiance_meter",
                "position": [0.0, 0.0, 1e-3],
                "look_at": [-x + (1e-3 if i == 2 else 0.0) for i, x in enumerate(travel)],
                "up": [-sin(radians(azimuth)), cos(radians(azimuth)), 0.0],
                "diameter": 1e-4,
                "cone_degrees": 0.01,
            }
            air = {"scattering": case["thickness"], "phase": {"type": "rayleigh", "depolarisation": 0.0}}
            document = lit_slab(air, 1.0, meter, below=True)
            del document["environment"], document["surfaces"][1]
            document["distant"] = [sun(degrees(acos(case["mu0"])), 180.0, irradiance=pi)]
            if case["ground"]:
                continue
            name = (
                f"Rayleigh layer, thickness {case['thickness']:g}, mu0 {case['mu0']:g}: up at mu {mu:g}, "
                f"azimuth {azimuth:g}"
            )
            yield Scene(document, (Value(name, truth, known["source"]),), 2**16)
