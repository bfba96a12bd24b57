"""Names of the entries of quick copies, which have a separate stream. Pure."""

QUICK = b"quick:"
"""Their first bytes."""


def is_quick(entry: bytes) -> bool:
    """Whether an entry is that of a quick copy."""
    return entry.startswith(QUICK)
