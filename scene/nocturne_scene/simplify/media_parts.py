"""Documents without a medium, or without a part of the atmosphere."""

from collections.abc import Iterator
from functools import partial

from nocturne_scene.simplify.simplification import Document, Simplification, member_lists

_ATMOSPHERE = ("air", "ozone", "aerosol")


def media_parts(document: Document) -> Iterator[Simplification]:
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
