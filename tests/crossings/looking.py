"""One scene: traced by all methods, judged, and looked at again where they differ."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from nocturne_client.errors import NocturneClientError
from nocturne_scene.document.read import check_document

from tests.accuracy.tracing import Document
from tests.crossings.features import features_of
from tests.crossings.judging import Difference, agree, differences, held, leans
from tests.crossings.methods import Readings, Refused, methods_of, traced
from tests.crossings.program import Failed
from tests.crossings.scenes import Scene

SEEDS = 8
SAMPLES = 32
"""Of a pixel by one seed, at the first look."""
_SUSPICIOUS = 0.01
"""Part of all sound scenes that is looked at again."""
_MORE = 16
"""Times as many samples at the second look."""
_STILL_MORE = 64
"""At the third."""
_SURE = 1e-3
"""What the second look must not find less probable than this."""
_SHRUNK = 0.5
"""A difference that falls to this part of itself with more samples is rare light, and no fault."""


@dataclass(frozen=True)
class Outcome:
    """The result of a scene."""

    scene: Scene
    probability: float
    """That methods which agree differ so much, by new samples; 1 where nothing was suspicious."""
    worst: Difference | None = None
    """Of the last look."""
    broken: Mapping[str, str] = field(default_factory=dict)
    """Methods that made no image, or invalid samples, and why."""
    refused: Mapping[str, str] = field(default_factory=dict)
    methods: tuple[str, ...] = ()
    looks: int = 1
    held: int = 0
    """Intervals that hold the truth, of `intervals`."""
    intervals: int = 0
    cpu_s: float = 0.0
    leans: Mapping[str, float] = field(default_factory=dict)
    """Leans of the methods except the first, from judging.leans."""


def look(scene: Scene, folder: Path, samples: int = SAMPLES, without: Collection[str] = ()) -> Outcome:
    """At a scene; `folder` has the files that it names. `without`: methods that are left out."""
    documents = {name: document for name, document in methods_of(scene).items() if name not in without}
    broken, refused = dict[str, str](), dict[str, str]()
    found: dict[str, Readings] = {}
    for name, document in documents.items():
        try:
            found[name] = traced(document, scene, folder, samples, SEEDS)
        except Refused as error:
            refused[name] = str(error)
        except (Failed, NocturneClientError) as error:
            broken[name] = _said(error)
    inside, intervals = held(found)
    outcome = Outcome(scene, 1.0, None, broken, refused, tuple(found), 1, inside, intervals)
    cpu_s = sum(each.cpu_s for each in found.values())
    outcome = replace(outcome, cpu_s=cpu_s, leans=leans(found) if len(found) > 1 else {})
    if agree(found) >= _SUSPICIOUS:
        return outcome
    return _again(outcome, documents, found, folder, samples)


def _again(
    outcome: Outcome,
    documents: Mapping[str, Document],
    found: Mapping[str, Readings],
    folder: Path,
    samples: int,
) -> Outcome:
    """With new seeds, and more samples."""
    pairs = differences(found)
    count = len(pairs)
    before = min(pairs, key=lambda each: each.probability)
    names = before.one, before.other
    for looks, more in ((2, _MORE), (3, _STILL_MORE)):
        try:
            newer = {
                name: traced(documents[name], outcome.scene, folder, more * samples, SEEDS, 100 * looks)
                for name in names
            }
        except Failed as error:
            return replace(outcome, broken={**outcome.broken, " or ".join(names): _said(error)})
        (now,) = differences(newer)
        cpu_s = outcome.cpu_s + sum(each.cpu_s for each in newer.values())
        probability = min(1.0, count * now.surely)
        outcome = replace(outcome, probability=probability, worst=now, looks=looks, cpu_s=cpu_s)
        if probability >= _SURE or (looks == 3 and abs(now.off) < _SHRUNK * abs(before.off)):
            return replace(outcome, probability=1.0)
        before = now
    return outcome


def features(scene: Scene) -> set[str]:
    """Of all of the scene's documents."""
    documents = [check_document(_with_digests(each)) for each in methods_of(scene).values()]
    return set[str]().union(*map(features_of, documents))


def _with_digests(value: object) -> object:
    """Files by a digest and a format, as a document that was uploaded has them."""
    if isinstance(value, dict):
        made = {name: _with_digests(inner) for name, inner in value.items()}
        if "asset" in made:
            if made.get("type") == "mesh":
                made.setdefault("format", str(value["asset"]).rpartition(".")[2])
            made["asset"] = "sha256:" + 64 * "0"
        return made
    return [_with_digests(inner) for inner in value] if isinstance(value, list) else value


def _said(error: Exception) -> str:
    problems = getattr(error, "problems", ())
    return "; ".join([str(error), *(f"{each.place}: {each.message}" for each in problems)])
