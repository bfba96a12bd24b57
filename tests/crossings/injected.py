"""Faults put in on purpose: in what one method traces a class of light has a part of its radiance."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import CompiledFolder

from tests.accuracy.tracing import Document
from tests.crossings import methods
from tests.crossings.scenes import Scene

METHOD = "mixture"
"""Whose images are wrong: all that is traced by the estimator of this name."""
PART = 0.9


def _lamps(scene: scene_pb2.CompiledScene) -> None:
    for lamp in scene.luminaires:
        lamp.radiance.spectrum = _part_of(scene, lamp.radiance.spectrum)


def _discs(scene: scene_pb2.CompiledScene) -> None:
    for disc in scene.distant_discs:
        disc.radiance = _part_of(scene, disc.radiance)


def _sky(scene: scene_pb2.CompiledScene) -> None:
    sky = scene.environment
    if sky.HasField("map"):
        sky.map.spectrum = _part_of(scene, sky.map.spectrum)
    elif scene.HasField("environment"):
        sky.constant = _part_of(scene, sky.constant)


def _glow(scene: scene_pb2.CompiledScene) -> None:
    for medium in scene.media:
        medium.emission_scale *= PART


CLASSES: Mapping[str, Callable[[scene_pb2.CompiledScene], None]] = {
    "lamps": _lamps,
    "discs": _discs,
    "sky": _sky,
    "glow": _glow,
}


def _part_of(scene: scene_pb2.CompiledScene, index: int) -> int:
    """Of a spectrum that others may use, too."""
    made = scene.spectra.add()
    made.CopyFrom(scene.spectra[index])
    made.values[:] = [PART * each for each in made.values]
    for line in made.lines:
        line.power *= PART
    return len(scene.spectra) - 1


def dim(monkeypatch: pytest.MonkeyPatch, light: str) -> None:
    """A class of light, from now on."""
    right = methods.compiled

    def wrong(document: Document, scene: Scene, folder: Path, samples: int) -> CompiledFolder:
        made = right(document, scene, folder, samples)
        if document["tracing"].get("estimator") == METHOD:
            message = scene_pb2.CompiledScene.FromString(made.scene.read_bytes())
            CLASSES[light](message)
            made.scene.write_bytes(message.SerializeToString(deterministic=True))
        return made

    monkeypatch.setattr(methods, "compiled", wrong)


def classes_in(document: Document) -> set[str]:
    """Which classes of light a scene has."""
    lights = {"distant": "discs", "environment": "sky"}
    found = {light for field, light in lights.items() if field in document}
    names = set(_names(document))
    return found | {
        light for name, light in (("luminaire", "lamps"), ("temperature", "glow")) if name in names
    }


def _names(value: object) -> Iterator[str]:
    if isinstance(value, dict):
        yield from value
        for inner in value.values():
            yield from _names(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _names(inner)
