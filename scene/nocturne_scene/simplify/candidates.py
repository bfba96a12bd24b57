"""All simplifications that a scene document allows: documents with a part less, or traced more simply."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from pydantic import TypeAdapter
from scipy.spatial.transform import Rotation

from nocturne_scene.compile.placement import motion_steps, placement_of
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.placement import KeyedMotion, Motion, RigidMotion
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError
from nocturne_scene.meshes.similarity import Similarity
from nocturne_scene.simplify.instances import small_instances
from nocturne_scene.simplify.simplification import Document, Find, Simplification, member_lists, objects
from nocturne_scene.simplify.textures import pictures
from nocturne_scene.spectra import indices


def candidates(document: Document, find: Find) -> list[Simplification]:
    """Those that leave a document that is different and can be rendered: with light, and something in it.

    Raises InputError where the document itself is not valid; errors of files as the compiler does.
    """
    checked = check_document(document)
    return [each for each in _all(document, checked, find) if _leaves_a_scene(each, document)]


def _all(document: Document, checked: SceneDocument, find: Find) -> Iterator[Simplification]:
    yield from _media_parts(document)
    yield from _dispersion(document)
    yield from pictures(document, find)
    yield from small_instances(checked, find)
    yield from _frozen(document)
    yield from _tracing_parts(document)


def _leaves_a_scene(simplification: Simplification, document: Document) -> bool:
    simpler = simplification.applied(document)
    if simpler == document:
        return False
    try:
        check_document(simpler)
    except InputError:
        return False
    return True


# --- without a medium, or without a part of the atmosphere ---


_ATMOSPHERE = ("air", "ozone", "aerosol")


def _media_parts(document: Document) -> Iterator[Simplification]:
    """Each medium alone, each part of the atmosphere where it has several, and the atmosphere."""
    for name in document.get("media", {}):
        yield Simplification(f'without medium "{name}"', partial(_leave_out_medium, name))
    atmosphere = document.get("atmosphere")
    if atmosphere is None:
        return
    # Air is there unless it is null.
    there = [part for part in _ATMOSPHERE if atmosphere.get(part, {} if part == "air" else None) is not None]
    if len(there) > 1:
        for part in there:
            yield Simplification(f"without the atmosphere's {part}", partial(_leave_out_air, part))
    yield Simplification("without the atmosphere", partial(_drop, "atmosphere"))


def _leave_out_medium(name: str, document: Document) -> None:
    """What only bounded it goes with it."""
    if name in document.get("unbounded_media", []):
        document["unbounded_media"] = [each for each in document["unbounded_media"] if each != name]
    for members in member_lists(document):
        members[:] = [member for member in members if not _was_only_boundary(member, name)]
    atmosphere = document.get("atmosphere") or {}
    if (atmosphere.get("aerosol") or {}).get("medium") == name:
        del atmosphere["aerosol"]


def _was_only_boundary(member: Document, name: str) -> bool:
    interior = member.get("interior")
    if interior is None or name not in interior["media"]:
        return False
    interior["media"] = [each for each in interior["media"] if each != name]
    if interior["media"]:
        return False
    del member["interior"]
    if member.get("kernel") is not None:
        return False
    if member.get("luminaire") is not None:
        member["kernel"] = {"type": "null"}
        return False
    return True


def _leave_out_air(part: str, document: Document) -> None:
    if document.get("atmosphere") is not None:
        document["atmosphere"][part] = None


def _drop(key: str, document: Document) -> None:
    document.pop(key, None)


# --- with one index of refraction for all wavelengths ---


SODIUM_NM = 589.29
"""Middle of the sodium D lines, to which a catalogue's n_D belongs."""

# Metals' indices, and those of thin layers, give them their colour and part no photons, so they stay.
_REFRACTING = ("dielectric", "thin_pane", "coated_diffuse", "principled")


def _dispersion(document: Document) -> Iterator[Simplification]:
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


# --- without motion ---


_MOTION: TypeAdapter[Any] = TypeAdapter(Motion)


def _frozen(document: Document) -> Iterator[Simplification]:
    """Everything where it is when half of the shutter's time has passed."""
    if any(_moves(each) for each in objects(document)):
        yield Simplification("nothing moves", _freeze)


def _moves(value: Document) -> bool:
    motion = value.get("motion")
    return isinstance(motion, dict) and (
        "translate" in motion or "rotate" in motion or "placements" in motion
    )


def _freeze(document: Document) -> None:
    for each in objects(document):
        if _moves(each):
            placement = _middle(_MOTION.validate_python(each["motion"]))
            # Twice the same: the compiler knows that as rest, and a thing's own placement stays as it is.
            each["motion"] = {"placements": [placement, placement]}


def _middle(motion: RigidMotion | KeyedMotion) -> Document:
    """The placement at half of the time. Between two given ones that differ by more than a shift it is the
    later one: points move in straight lines there, which is no placement."""
    if isinstance(motion, RigidMotion):
        turn = motion.rotate and motion.rotate.model_copy(update={"degrees": motion.rotate.degrees / 2})
        x, y, z = motion.translate
        return _written(motion_steps(RigidMotion(rotate=turn, translate=(x / 2, y / 2, z / 2)))[-1])
    steps = [placement_of(each) for each in motion.placements]
    middle, before = steps[len(steps) // 2], steps[(len(steps) - 1) // 2]
    if np.array_equal(before.rotation, middle.rotation) and before.scale == middle.scale:
        return _written(Similarity(middle.scale, middle.rotation, 0.5 * (before.shift + middle.shift)))
    return _written(middle)


def _written(step: Similarity) -> Document:
    placement: Document = {"translate": step.shift.tolist()}
    if step.scale != 1.0:
        placement["scale"] = float(step.scale)
    turn = Rotation.from_matrix(step.rotation).as_rotvec(degrees=True)
    degrees = float(np.linalg.norm(turn))
    if degrees > 0.0:
        placement["rotate"] = {"axis": (turn / degrees).tolist(), "degrees": degrees}
    return placement


# --- with the same parts, traced more simply ---


DEPTHS = (2, 4, 8, 16)
"""Limits of depth that are tried, interactions."""


def _tracing_parts(document: Document) -> Iterator[Simplification]:
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
