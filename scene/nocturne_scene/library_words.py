"""Messages of other libraries and programs about a file, made fit for its sender.

Without this machine's paths, and without names of exceptions."""

import re
from collections.abc import Callable

_MOST = 200

# An absolute path, in quotation marks or parentheses or without: two names at least, so that "m/s" stays.
_PATH = re.compile(r"""["'(]?(?<![\w.])/(?:[^\s/"'():]+/)+[^\s"'():,;]*["')]?""")


_EXCEPTION = re.compile(r"\b[A-Z]\w*(?:Error|Exception): ")


def without_paths(said: str, most: int = _MOST) -> str:
    """The text with "the file" for each path, in one line, at most `most` characters."""
    text = " ".join(_EXCEPTION.sub("", _PATH.sub("the file", said)).split())
    return text if len(text) <= most else text[: most - 3] + "..."


def said_by(ask: Callable[[], str]) -> str:
    """What a library says when it is asked, without paths; also where it repeats bytes that are no text."""
    try:
        return without_paths(ask())
    except UnicodeDecodeError:
        return "it has names that are no text"
