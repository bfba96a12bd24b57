"""All simplifications that a scene document allows."""

from collections.abc import Iterator

from nocturne_coordinator.errors import InputError
from nocturne_coordinator.needs.dispersion import dispersion
from nocturne_coordinator.needs.instances import small_instances
from nocturne_coordinator.needs.media_parts import media_parts
from nocturne_coordinator.needs.moving_parts import frozen
from nocturne_coordinator.needs.pictures import pictures
from nocturne_coordinator.needs.simplification import Document, Find, Simplification
from nocturne_coordinator.needs.tracing_parts import tracing_parts
from nocturne_coordinator.scene.document import check_document
from nocturne_coordinator.scene.model import SceneDocument


def candidates(document: Document, find: Find) -> list[Simplification]:
    """Those that leave a document that is different and can be rendered: with light, and something in it.

    Raises InputError where the document itself is not valid; errors of files as the compiler does.
    """
    checked = check_document(document)
    return [each for each in _all(document, checked, find) if _leaves_a_scene(each, document)]


def _all(document: Document, checked: SceneDocument, find: Find) -> Iterator[Simplification]:
    yield from media_parts(document)
    yield from dispersion(document)
    yield from pictures(document, find)
    yield from small_instances(checked, find)
    yield from frozen(document)
    yield from tracing_parts(document)


def _leaves_a_scene(simplification: Simplification, document: Document) -> bool:
    simpler = simplification.applied(document)
    if simpler == document:
        return False
    try:
        check_document(simpler)
    except InputError:
        return False
    return True
