"""What the bench of rare light found, for the page."""

import json
from typing import Any

from nocturne_client.local.programs import CHECKOUT


def rare_light() -> dict[str, Any] | None:
    """None where it was not run yet."""
    latest: dict[str, Any] = json.loads((CHECKOUT / "bench" / "results" / "latest.json").read_text())
    return latest.get("rare_light")
