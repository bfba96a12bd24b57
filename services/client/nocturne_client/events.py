"""Server-sent events, as far as the service uses them."""

import json
from collections.abc import Iterable, Iterator
from typing import Any


def data_of(lines: Iterable[str]) -> Iterator[dict[str, Any]]:
    """The JSON data of each event; comments, names and ids are passed over."""
    data: list[str] = []
    for line in lines:
        if line.startswith("data:"):
            data.append(line.removeprefix("data:").removeprefix(" "))
        elif not line and data:
            yield json.loads("\n".join(data))
            data = []
