"""The compared methods of tracing: the tracer's own and the baselines."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from nocturne_scene.document.checks import CAMERAS, MET_BY_PHOTONS
from nocturne_scene.simplify.simplification import objects

from bench.scenes import Document


def _always(document: Document) -> bool:
    del document
    return True


def _can_be_hit(document: Document) -> bool:
    return document["sensor"]["type"] in MET_BY_PHOTONS


_MIRRORS = {"conductor", "dielectric", "thin_pane", "coated_diffuse"}


def gathers(document: Document) -> bool:
    """A camera, and something in the scene that may be a mirror or glass."""
    kinds = (each.get("type") for each in objects(document))
    return document["sensor"]["type"] in CAMERAS and not _MIRRORS.isdisjoint(kinds)


def _no_media(document: Document) -> bool:
    return not (document.get("media") or document.get("atmosphere"))


def _only_media(document: Document) -> bool:
    """Something to march through, and nothing that the marcher passes by: it follows light through matched
    boundaries only."""
    bodies = [surface.get("kernel") for surface in document.get("surfaces", [])]
    dielectrics = any(isinstance(kernel, dict) and kernel["type"] == "dielectric" for kernel in bodies)
    return bool(document.get("media")) and "unbounded_media" not in document and not dielectrics


@dataclass(frozen=True)
class Way:
    """A method of tracing."""

    name: str
    about: str
    tracing: dict[str, Any] = field(default_factory=dict)
    sensor: dict[str, Any] = field(default_factory=dict)
    baseline: tuple[str, ...] = ()
    """Options of nocturne-baseline, where that traces."""
    applies: Callable[[Document], bool] = _always
    samples: float = 1.0
    """Factor of a number of samples, so that methods take about the same time."""

    def document(self, document: Document) -> Document:
        """The document, traced by this method."""
        return {
            **document,
            "tracing": {**document.get("tracing", {}), "direction": "adjoint", "sharing": 1, **self.tracing},
            "sensor": {**document["sensor"], **self.sensor},
        }


FORWARD = Way(
    "forward",
    "photons from the luminaires",
    {"direction": "forward"},
    applies=_can_be_hit,
    samples=16,
)

WAYS = (
    Way("two photons", "each pixel alone: one photon by the kernel, one towards lights"),
    Way(
        "kernel only",
        "directions by the kernel alone",
        {"estimator": "mixture", "mixture": {"kernel": 1.0, "luminaires": 0.0, "environment": 0.0}},
    ),
    Way("mixture", "one photon, drawn from kernel, luminaires and environment", {"estimator": "mixture"}),
    Way("split", "both at the first vertex, power heuristic", {"estimator": "split"}),
    FORWARD,
    Way(
        "both directions",
        "photons from the luminaires for what mirrors and glass gather, the default for the rest",
        {"direction": "both"},
        applies=gathers,
        samples=0.5,
    ),
    Way("uniform", "the default with wavelengths drawn uniformly", sensor={"wavelengths": "uniform"}),
    Way("independent", "the default with independent random numbers", {"sequence": "independent"}),
    Way("path", "baseline: path tracing", baseline=("--method", "path"), applies=_no_media, samples=0.125),
    Way("march", "baseline: ray marching, 64 steps", baseline=("--method", "march"), applies=_only_media),
)
