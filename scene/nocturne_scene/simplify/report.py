"""What was found, for programs."""

from math import isfinite
from typing import Any

from nocturne_scene.simplify.choosing import Model, verdict
from nocturne_scene.simplify.pilot import RENDERS
from nocturne_scene.simplify.search import Needs


def as_json(needs: Needs) -> dict[str, Any]:
    """For programs. Errors are relative, times seconds of one processor; null: out of reach."""
    request = needs.request
    return {
        "error": request.error,
        "film": [request.width, request.height],
        "pilot": {
            "film": list(needs.film),
            "samples": needs.samples,
            "renders": RENDERS,
            "cpu_seconds": needs.cpu_s,
            "wanted_cpu_seconds": needs.wanted_s or None,
            "effective_pixels": needs.effective_pixels,
            "heavy_tails": needs.rare,
        },
        "full": _model(needs.full, needs),
        "models": [_model(each, needs) for each in needs.models],
        "chosen": _model(needs.chosen, needs),
        "saving": needs.saving,
        "without_effect": needs.without_effect,
    }


def _model(model: Model, needs: Needs) -> dict[str, Any]:
    samples = model.samples_for(needs.request.error)
    reachable = isfinite(samples)
    return {
        "without": [part.name for part in model.parts],
        "verdict": verdict(model, needs.request.error) if model.parts else "full",
        "mean_bias": vars(model.bias.mean),
        "local_bias": vars(model.bias.local),
        "noise_of_a_sample": model.noise,
        "cost_ratio": vars(model.cost),
        "samples": int(samples) if reachable else None,
        "cpu_seconds": model.seconds_for(needs.request.error, needs.pixels) if reachable else None,
    }
