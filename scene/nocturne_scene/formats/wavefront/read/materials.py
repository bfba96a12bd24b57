"""MTL files: materials by name, as kernels and luminaires."""

import math
from collections.abc import Iterator
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.colours import Json, light, reflectance
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.texts import text_of

GREY: Json = {"type": "lambertian", "reflectance": 0.5}
_NUMBERS = {"Kd": 3, "Ke": 3, "Ks": 3, "Ka": 3, "Tf": 3, "d": 1, "Tr": 1, "Ns": 1, "Ni": 1, "illum": 1}
_MAPS = ("map_", "bump", "disp", "decal", "refl", "norm")


def materials_of(file: Path, findings: Findings) -> Iterator[tuple[str, Json, Json]]:
    """Name, kernel and radiance, None for materials that do not emit. Raises InputError with the line."""
    name, place, found = "", "", dict[str, list[float]]()
    with file.open("rb") as binary, text_of(binary) as lines:
        for number, line in enumerate(lines, start=1):
            words = line.partition("#")[0].split()
            here = f"{file.name}, line {number}"
            if words[:1] == ["newmtl"]:
                if name:
                    yield name, *_made(name, found, place, findings)
                name, place, found = " ".join(words[1:]) or "unnamed", here, {}
            elif words and words[0] in _NUMBERS:
                found[words[0]] = _numbers(words, here)
            elif words and words[0].startswith(_MAPS):
                findings.lost(
                    here, f"the picture of {words[0]} is not read; the material has its even colour"
                )
    if name:
        yield name, *_made(name, found, place, findings)


def _numbers(words: list[str], place: str) -> list[float]:
    try:
        values = [float(word) for word in words[1:]]
    except ValueError:
        values = []
    count = _NUMBERS[words[0]]
    if count == 3 and len(values) == 1:
        values *= 3
    if len(values) < count or not all(math.isfinite(each) and each >= 0.0 for each in values):
        raise InputError.at(place, f"{words[0]}: expected {count} numbers that are not negative")
    return values[:count]


def _made(name: str, found: dict[str, list[float]], place: str, findings: Findings) -> tuple[Json, Json]:
    colour = [min(1.0, each) for each in found.get("Kd", [0.5] * 3)]
    emitted = found.get("Ke", [0.0] * 3)
    radiance = light(emitted, 1.0) if max(emitted) > 0.0 else None
    if radiance is not None:
        findings.note(place, f"{name} emits: Ke of 1 is 1 cd/m2 of D65; give it lumens in the document")
    kernel: Json = {"type": "lambertian", "reflectance": reflectance(colour)}
    shine, exponent = max(found.get("Ks", [0.0])), found.get("Ns", [0.0])[0]
    if shine > 0.0 and exponent > 0.0:
        # Microfacets of Beckmann's alpha are as wide as Blinn's lobe of that exponent: B. Walter 2007, (35).
        alpha = math.sqrt(2.0 / (exponent + 2.0))
        kernel = {
            "type": "principled",
            "base": reflectance(colour),
            "roughness": math.sqrt(alpha),
            "specular_colour": min(1.0, shine),
        }
        findings.note(place, f"{name}: its highlight becomes one of microfacets")
    opacity = found["d"][0] if "d" in found else 1.0 - found.get("Tr", [0.0])[0]
    if opacity < 1.0:
        findings.note(
            place, f"{name}: {1.0 - opacity:.0%} of the light passes straight on, without refraction"
        )
        kernel = {"type": "mask", "kernel": kernel, "opacity": max(0.0, opacity)}
    return kernel, radiance
