"""A method that is wrong is found, and so are the parts of a scene that it is wrong with."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from nocturne_scene.validation.documents import furnace

from tests.accuracy.tracing import Document, write
from tests.crossings import assets, injected, methods
from tests.crossings.judging import ALPHA
from tests.crossings.looking import Outcome, look
from tests.crossings.scenes import Scene, scene
from tests.crossings.smallest import smallest

pytestmark = pytest.mark.system

_WITH_A_MASK = 58
"""Seed of a scene that shows one."""
_WITH_A_SUN = 26
"""Seed of a scene with discs at infinity and much else."""
_SAMPLES = 8


def _break(monkeypatch: pytest.MonkeyPatch, wrong: Callable[[Any], Any]) -> None:
    """Whatever is traced by the estimator "mixture" is another scene."""

    def write_wrong(document: Document, folder: Path) -> Path:
        is_mixture = document["tracing"].get("estimator") == "mixture"
        return write(wrong(document) if is_mixture else document, folder)

    monkeypatch.setattr(methods, "write", write_wrong)


def _darker(value: Any) -> Any:
    """Reflectances are 5 % less."""
    if isinstance(value, list):
        return [_darker(each) for each in value]
    if not isinstance(value, dict):
        return value
    made = {name: _darker(inner) for name, inner in value.items()}
    if made.get("reflectance") == "wall":
        made["reflectance"] = 0.475
    return made


def _without_masks(value: Any) -> Any:
    """The value with all masks opaque."""
    if isinstance(value, list):
        return [_without_masks(each) for each in value]
    if not isinstance(value, dict):
        return value
    if value.get("type") == "mask":
        return _without_masks(value["kernel"])
    return {name: _without_masks(inner) for name, inner in value.items()}


def _is_found(outcome: Outcome) -> bool:
    """Also among a thousand scenes."""
    return outcome.probability < ALPHA / 1000.0


def test_an_albedo_that_is_five_percent_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """1 / (1 - 0.475) instead of 1 / (1 - 0.5)."""
    sound = Scene(0, furnace(0.5, 2.0), 8, 8, wide=True)
    assert look(sound, tmp_path, _SAMPLES).probability == 1.0
    _break(monkeypatch, _darker)
    found = look(sound, tmp_path, _SAMPLES)
    assert _is_found(found)
    assert found.worst is not None
    assert "mixture" in (found.worst.one, found.worst.other)
    assert abs(found.worst.off) == pytest.approx(0.05, abs=0.02)


def _parts(document: Document) -> int:
    return sum(len(document.get(name, [])) for name in ("surfaces", "instances"))


def test_a_fault_of_distant_light_is_found_and_reduced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assets.write(tmp_path)
    injected.dim(monkeypatch, "discs")
    whole = scene(_WITH_A_SUN)
    found = look(whole, tmp_path, _SAMPLES, (methods.CHOSEN, "varied", "other"))
    assert _is_found(found)
    small = smallest(found, tmp_path, float("inf"), 40)
    assert injected.classes_in(small) == {"discs"}
    assert _parts(small) <= 2 < _parts(whole.document)
    assert f"seed {_WITH_A_SUN}: mixture / " in small["note"] or "/ mixture" in small["note"]


@pytest.mark.soak
@pytest.mark.parametrize("light", injected.CLASSES)
def test_a_tenth_of_a_class_of_light_is_found_in_300_scenes(
    light: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the samples of `make crossings`, and reduced to few parts that still have it."""
    assets.write(tmp_path)
    injected.dim(monkeypatch, light)
    scenes = (each for each in map(scene, range(300)) if light in injected.classes_in(each.document))
    outcomes = (look(each, tmp_path, without=(methods.CHOSEN, "varied", "other")) for each in scenes)
    found = next(filter(_is_found, outcomes))
    small = smallest(found, tmp_path, 60.0)
    assert light in injected.classes_in(small)
    assert _parts(small) <= 3


@pytest.mark.soak
def test_a_fault_of_masks_is_reduced_to_a_mask(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assets.write(tmp_path)
    _break(monkeypatch, _without_masks)
    found = look(scene(_WITH_A_MASK), tmp_path)
    assert _is_found(found)
    small = smallest(found, tmp_path, 240.0)
    assert '"mask"' in repr(small).replace("'", '"')
    assert len(small.get("surfaces", [])) + len(small.get("instances", [])) <= 3
