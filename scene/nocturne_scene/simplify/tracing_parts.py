"""Documents that are traced more simply: shorter paths, and fewer techniques."""

from collections.abc import Iterator
from functools import partial
from typing import Any

from nocturne_scene.simplify.simplification import Document, Simplification

DEPTHS = (2, 4, 8, 16)
"""Limits of depth that are tried, interactions."""


def tracing_parts(document: Document) -> Iterator[Simplification]:
    """Limits of depth; and with the same image: earlier roulette, no splits, no second or forward photons."""
    tracing = document.get("tracing", {})
    limit = tracing.get("maximum_depth")
    for depth in DEPTHS:
        if limit is None or depth < limit:
            yield Simplification(
                f"at most {depth} interactions", partial(_set, {"maximum_depth": depth}), kind="depth"
            )
    yield _exactly("roulette from the first interaction", {"roulette_after": 0, "h": 1.0}, "roulette")
    estimator = tracing.get("estimator", "two_photons")
    if estimator == "split":
        yield _exactly("two photons at a vertex instead of splits", {"estimator": "two_photons"}, "estimator")
    if estimator != "mixture":
        yield _exactly("one photon at a vertex", {"estimator": "mixture"}, "estimator")
    if tracing.get("direction", "adjoint") != "adjoint":
        yield _exactly("adjoint photons instead of forward ones", {"direction": "adjoint"}, "direction")


def _exactly(name: str, changes: dict[str, Any], kind: str) -> Simplification:
    return Simplification(name, partial(_set, changes), exact=True, kind=kind)


def _set(changes: dict[str, Any], document: Document) -> None:
    tracing = document.setdefault("tracing", {})
    tracing.update(changes)
    if tracing.get("estimator") != "split":
        tracing.pop("split_vertices", None)
