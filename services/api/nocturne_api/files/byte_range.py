"""Which bytes of a file an HTTP request asks for (RFC 9110, 14.1.2)."""

import re

_ONE = re.compile(r"bytes=(\d{1,18})?-(\d{1,18})?")


def asked_range(header: str, size: int) -> range | None:
    """The bytes; empty where the file has none of them; None where all are asked for, or several parts, of
    which all may be sent."""
    match = _ONE.fullmatch(header.replace(" ", ""))
    if match is None or match.group(0) == "bytes=-":
        return None
    first, last = match.groups()
    if first is None:
        return range(max(0, size - int(last)), size)
    if last is not None and int(last) < int(first):
        return None
    return range(int(first), size if last is None else min(size, int(last) + 1))
