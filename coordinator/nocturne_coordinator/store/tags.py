"""Tags: words that people sort renders by, and what a search looks through."""

from collections.abc import Sequence

from nocturne_scene.errors import InputError, Problem

MAX_TAGS = 20
_MAX_TAG = 100

TAGGED = "EXISTS (SELECT 1 FROM json_each(tags) WHERE value = ?)"
"""Of a row of `render`: whether it has a tag."""

SEARCHED = (
    "instr(casefold(name || ' ' || id || ' ' || owner || ' ' || state || ' ' || in_group || ' ' || tags), ?) "
    "> 0"
)
"""Of a row of `render`: whether something that it is called by has a word, in the form of `words_of`."""


def checked_tags(tags: Sequence[str]) -> tuple[str, ...]:
    """Each once, in order. Raises InputError."""
    problems = [
        Problem(f"$.tags[{index}]", f"expected 1 to {_MAX_TAG} printable characters without a comma")
        for index, tag in enumerate(tags)
        if not (tag.strip() and len(tag) <= _MAX_TAG and tag.isprintable() and "," not in tag)
    ]
    if len(tags) > MAX_TAGS:
        problems.append(Problem("$.tags", f"expected at most {MAX_TAGS}"))
    if problems:
        raise InputError(problems)
    return tuple(dict.fromkeys(tag.strip() for tag in tags))


def words_of(search: str) -> list[str]:
    """What a render must have, all of it, whatever its case in any alphabet."""
    return search.casefold().split()
