"""Documents whose indices of refraction don't depend on wavelength."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from nocturne_scene.simplify.simplification import Document, Simplification, objects
from nocturne_scene.spectra import indices

SODIUM_NM = 589.29
"""Middle of the sodium D lines, to which a catalogue's n_D belongs."""

# Metals' indices, and those of thin layers, give them their colour and part no photons, so they stay.
_REFRACTING = ("dielectric", "thin_pane", "coated_diffuse", "principled")


def dispersion(document: Document) -> Iterator[Simplification]:
    """One index for all wavelengths, where there is another."""
    if any(_disperses(each) for each in objects(document)):
        yield Simplification(f"one index of refraction, at {SODIUM_NM:g} nm", _one_index)


def _disperses(value: Document) -> bool:
    kind = value.get("type")
    return (
        isinstance(kind, str) and kind in _REFRACTING and not isinstance(value.get("index", 1.5), int | float)
    )


def _one_index(document: Document) -> None:
    for each in objects(document):
        if _disperses(each):
            each["index"] = _at_sodium(each["index"])


def _at_sodium(index: Any) -> float:
    """Of an index as documents write it; the document is valid."""
    at = np.array([SODIUM_NM])
    if isinstance(index, str):
        n = indices.dielectric(index).n(at)
    elif "sellmeier" in index:
        n = indices.sellmeier(index["sellmeier"]["b"], index["sellmeier"]["c"])(at)
    elif "cauchy" in index:
        n = indices.cauchy(index["cauchy"])(at)
    else:
        wavelengths, values = zip(*index["table"], strict=True)
        n = np.interp(at, wavelengths, values)
    return round(float(n[0]), 6)
