"""Reads scene documents.

JSON text in, a checked `SceneDocument` or the list of everything wrong with it out.
"""

from itertools import islice
from typing import Any

from pydantic import ValidationError

from nocturne_scene.document import bounds
from nocturne_scene.document.checks import whole_document_problems
from nocturne_scene.document.json_text import decode_json
from nocturne_scene.document.model import SceneDocument, context_for
from nocturne_scene.document.problems import problems_of
from nocturne_scene.errors import InputError

__all__ = ["SceneDocument", "check_document", "parse_document"]


def parse_document(text: bytes | str) -> SceneDocument:
    """Return the document that `text` (JSON, UTF-8) holds.

    Raises InputError with at most `bounds.PROBLEMS` problems; each place is a path such as
    `$.surfaces[3].kernel`.
    """
    return check_document(decode_json(text))


def check_document(value: Any) -> SceneDocument:
    """Like parse_document, for JSON that was decoded already.

    Duplicate keys and depth are the decoder's affair.
    """
    if not isinstance(value, dict):
        raise InputError.at(
            "$", 'expected an object, such as {"nocturne": 1, "sensor": {...}, "surfaces": [...]}'
        )
    try:
        document = SceneDocument.model_validate(value, context=context_for(value))
    except ValidationError as error:
        raise InputError(problems_of(error, SceneDocument)) from None
    problems = list(islice(whole_document_problems(document), bounds.PROBLEMS))
    if problems:
        raise InputError(problems)
    return document
