"""The smallest scene by which two methods still differ."""

import sys
from pathlib import Path
from typing import Any

from nocturne_client.errors import NocturneClientError

from tests.accuracy.tracing import Document
from tests.crossings.judging import differences
from tests.crossings.looking import SEEDS, Outcome
from tests.crossings.methods import Readings, Refused, methods_of, traced
from tests.crossings.program import Failed
from tests.crossings.reducing import inlined, reduced

_PROBABILITY = 1e-4
"""By seeds as well as by stated errors."""
_SAMPLES = (16, 64, 256, 1024)
"""Of a pixel by one seed: the fewest by which the whole scene fails."""
_KEPT = 0.5
"""Part of the difference that a smaller scene must have, too."""


def smallest(fault: Outcome, folder: Path, seconds: float, tries: int = sys.maxsize) -> Document:
    """A document with a note on what differs; one that no method traces stays whole."""
    documents = methods_of(fault.scene)
    worst = fault.worst
    names = list(fault.broken) if worst is None else [worst.one, worst.other]
    whole = {
        "document": inlined(fault.scene.document),
        "ways": {name: _own(documents[name], fault.scene.document) for name in names if name in documents},
    }

    def traced_by(candidate: Any, name: str, samples: int) -> Readings:
        tracing = {**candidate["document"].get("tracing", {}), **candidate["ways"][name]}
        return traced(candidate["document"] | {"tracing": tracing}, fault.scene, folder, samples, SEEDS)

    def fails(candidate: Any, samples: int) -> bool:
        try:
            found = {name: traced_by(candidate, name, samples) for name in names}
        except Failed:
            return worst is None
        except (Refused, NocturneClientError, KeyError, TypeError, AttributeError):
            return False
        if worst is None:
            return False
        (now,) = differences(found)
        return now.surely < _PROBABILITY and abs(now.off) >= _KEPT * abs(worst.off)

    samples = next((each for each in _SAMPLES[:-1] if fails(whole, each)), _SAMPLES[-1])
    small = reduced(whole, lambda candidate: fails(candidate, samples), seconds, tries)
    film = f"film {fault.scene.width}x{fault.scene.height}, {samples} samples, seeds 1 to {SEEDS}"
    why = str(worst) if worst is not None else "; ".join(fault.broken.values())
    ways = "; ".join(f"{name}: {way}" for name, way in small["ways"].items())
    note = f"seed {fault.scene.seed}: {why}; {film}; {ways}"
    last = [*small["ways"].values(), {}][len(names) - 1]
    return {**small["document"], "note": note, "tracing": {**small["document"].get("tracing", {}), **last}}


def _own(document: Document, scene: Document) -> Document:
    """How it is traced, but for what changes the image: that is the scene's."""
    kept = scene.get("tracing", {})
    return {name: value for name, value in document["tracing"].items() if name not in kept}
