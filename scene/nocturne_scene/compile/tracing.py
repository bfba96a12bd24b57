"""How photons are traced, as a message: weights for what the scene has, and choices made for `auto`."""

from collections.abc import Mapping

from nocturne.v1 import scene_pb2

from nocturne_scene.compile.environment import has_sky
from nocturne_scene.compile.ways import DIRECTIONS, Ways
from nocturne_scene.compile.workspace import Workspace
from nocturne_scene.document.tracing import Mixture, Tracing

# Part of the weight for aimed directions, where the document does not say.
AIMED = 0.35

# Interactions of a photon where the document does not say.
NO_LIMIT = 0

_SEQUENCES = {
    "sobol": scene_pb2.SAMPLE_SEQUENCE_SOBOL,
    "independent": scene_pb2.SAMPLE_SEQUENCE_INDEPENDENT,
}
_ROULETTES = {
    "weight": scene_pb2.ROULETTE_WEIGHT,
    "albedo": scene_pb2.ROULETTE_ALBEDO,
}
_H = {"weight": 4.0, "albedo": 1.0}
_ESTIMATORS = {
    "two_photons": scene_pb2.ESTIMATOR_TWO_PHOTONS,
    "mixture": scene_pb2.ESTIMATOR_MIXTURE,
    "split": scene_pb2.ESTIMATOR_SPLIT,
}


def compile_tracing(
    workspace: Workspace, scene: scene_pb2.CompiledScene, ways: Ways, *, scatters: bool
) -> scene_pb2.Tracing:
    """Return how to trace a scene whose other parts are compiled; `scatters`: something sends light on.

    The settings are the document's, or a pilot's where the document leaves them open.
    """
    tracing = workspace.document.tracing
    there = {
        "luminaires": bool(scene.luminaires),
        "environment": has_sky(scene),
        # The learned light is for photons from luminaires alone.
        "important": bool(scene.important_shapes) and not ways.aims,
    }
    weights = _weights(tracing.mixture, there)
    if not scatters:
        workspace.dropped.append("$.tracing.mixture: nothing scatters light, so no direction is ever chosen")
        weights = dict.fromkeys(weights, 0.0)
    elif not sum(weights.values()) > 0:
        workspace.dropped.append(
            "$.tracing.mixture: the scene has nothing that its weights are for, so all weight is the kernel's"
        )
    total = sum(weights.values())
    if not total > 0:
        weights["kernel"] = total = 1.0
    share = {way: weight / total for way, weight in weights.items()}
    return scene_pb2.Tracing(
        h=_H[tracing.roulette] if tracing.h is None else tracing.h,
        roulette=_ROULETTES[tracing.roulette],
        roulette_after=tracing.roulette_after,
        maximum_depth=NO_LIMIT if tracing.maximum_depth is None else tracing.maximum_depth,
        weight_kernel=share["kernel"],
        weight_luminaires=share["luminaires"],
        weight_uniform=share["uniform"],
        weight_environment=share["environment"],
        weight_important=share["important"],
        sequence=_SEQUENCES[tracing.sequence],
        seed=tracing.seed,
        estimator=_ESTIMATORS[tracing.estimator],
        split_vertices=tracing.split_vertices if tracing.estimator == "split" else 0,
        group=_group(tracing, ways, scene),
        direction=DIRECTIONS[ways.direction],
        sharing=_sharing(workspace, ways),
        aimed_emission=_aimed_emission(workspace, scene, ways),
        forward_ratio=_forward_ratio(workspace, ways),
    )


def _weights(mixture: Mixture, there: Mapping[str, bool]) -> dict[str, float]:
    """Weights as the document or else `Mixture` says; zero where the scene has nothing to aim at."""
    given = {name: getattr(mixture, name) for name in there}
    if mixture.is_open:
        share = AIMED / max(1, sum(there.values()))
        aimed = {name: share if is_there else 0.0 for name, is_there in there.items()}
    else:
        aimed = {name: (given[name] or 0.0) if is_there else 0.0 for name, is_there in there.items()}
    return {"kernel": mixture.kernel, **aimed, "uniform": mixture.uniform}


def _aimed_emission(workspace: Workspace, scene: scene_pb2.CompiledScene, ways: Ways) -> float:
    if not ways.aimed_emission:
        return 0.0
    if ways.direction == "adjoint":
        why = "no photons start at luminaires"
    elif not scene.important_shapes:
        why = "the scene has no important directions"
    else:
        return ways.aimed_emission
    workspace.dropped.append(f"$.tracing.aimed_emission: {why}")
    return 0.0


def _forward_ratio(workspace: Workspace, ways: Ways) -> float:
    """0, which means 1, where it is not used: a scene has one spelling."""
    if ways.forward_ratio == 1.0:
        return 0.0
    if ways.direction == "both":
        return ways.forward_ratio
    workspace.dropped.append("$.tracing.forward_ratio: photons do not go both ways")
    return 0.0


def _sharing(workspace: Workspace, ways: Ways) -> int:
    if ways.sharing == 1:
        return 1
    if ways.direction == "forward":
        why = "no photons start at pixels"
    elif workspace.document.tracing.estimator != "two_photons":
        why = 'only the estimator "two_photons" can share'
    else:
        return ways.sharing
    workspace.dropped.append(f"$.tracing.sharing: {why}")
    return 1


def _group(tracing: Tracing, ways: Ways, scene: scene_pb2.CompiledScene) -> int:
    if tracing.photons_together != "auto":
        return tracing.photons_together
    # Photons that start in media part there at once.
    return 1 if ways.direction == "forward" and scene.media else 4
