"""All simplifications that a scene document allows."""

from collections.abc import Iterator

from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError
from nocturne_scene.simplify.dispersion import dispersion
from nocturne_scene.simplify.instances import small_instances
from nocturne_scene.simplify.media_parts import media_parts
from nocturne_scene.simplify.moving_parts import frozen
from nocturne_scene.simplify.simplification import Document, Find, Simplification
from nocturne_scene.simplify.textures import pictures
from nocturne_scene.simplify.tracing_parts import tracing_parts


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
