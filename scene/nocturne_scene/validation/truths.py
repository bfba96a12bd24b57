"""Published and closed-form values that lie here as JSON files, each with its sources."""

import json
from functools import lru_cache
from importlib import resources
from typing import Any, Literal


@lru_cache(maxsize=4)
def truths(name: Literal["cie171", "interfaces", "media", "polarisation"]) -> dict[str, Any]:
    """The file of that name; nobody may change it."""
    found: dict[str, Any] = json.loads(
        resources.files("nocturne_scene.validation").joinpath(f"{name}.json").read_text("utf-8")
    )
    return found
