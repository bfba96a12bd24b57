"""The results of a preflight, for programs."""

from math import isfinite
from typing import Any

from nocturne_scene.simplify.choosing import Model, verdict
from nocturne_scene.simplify.pilot import RENDERS
from nocturne_scene.simplify.search import Preflight


def as_json(preflight: Preflight) -> dict[str, Any]:
    """For programs. Errors are relative, times seconds of one processor; null: out of reach."""
    request = preflight.request
    return {
        "error": request.error,
        "film": [request.width, request.height],
        "pilot": {
            "film": list(preflight.film),
            "samples": preflight.samples,
            "renders": RENDERS,
            "cpu_seconds": preflight.cpu_s,
            "recommended_cpu_seconds": preflight.wanted_s or None,
            "effective_pixels": preflight.effective_pixels,
            "heavy_tails": preflight.rare,
        },
        "full": _model(preflight.full, preflight),
        "models": [_model(each, preflight) for each in preflight.models],
        "chosen": _model(preflight.chosen, preflight),
        "saving": preflight.saving,
        "without_effect": preflight.without_effect,
    }


def _model(model: Model, preflight: Preflight) -> dict[str, Any]:
    samples = model.samples_for(preflight.request.error)
    reachable = isfinite(samples)
    return {
        "without": [part.name for part in model.parts],
        "verdict": verdict(model, preflight.request.error) if model.parts else "full",
        "mean_bias": vars(model.bias.mean),
        "local_bias": vars(model.bias.local),
        "noise_of_a_sample": model.noise,
        "cost_ratio": vars(model.cost),
        "samples": int(samples) if reachable else None,
        "cpu_seconds": model.seconds_for(preflight.request.error, preflight.pixels) if reachable else None,
    }
