"""A scene while it is made: what random choices come from, and what parts of it name."""

from dataclasses import dataclass, field
from typing import Any

from tests.accuracy.tracing import Document
from tests.crossings.chance import Chance

_NAMED = 0.3
"""How often a spectrum, a texture or a kernel is named instead of written where it is used."""

_ALONG = {"texture", "roughness_u", "roughness_across", "rotation"}
"""Fields of kernels that look at where on a surface they are, or along what."""


@dataclass
class Draft:
    """Parts of a document that others refer to."""

    chance: Chance
    sharp: bool
    """Whether mirrors and glass may be in it. Else lamps may be small: light of a small lamp that mirrors or
    glass gather is met by chance alone from the sensor, and no number of samples that a test can pay shows
    a method that is wrong."""
    small_lamps: bool = False
    """Whether a lamp is so small that photons which are not sent to it meet it seldom."""
    named: dict[str, dict[str, Any]] = field(default_factory=dict)
    under_meters: list[Document] = field(default_factory=list)
    """Surfaces on whose faces meters are."""
    situations: set[str] = field(default_factory=set)
    """What the schema has no word for, see SITUATIONS in scenes.py."""

    def used(self, collection: str, value: Any) -> Any:
        """The value, or the name under which it now stands in `$.<collection>`."""
        return self.name(collection, value) if self.chance.maybe(_NAMED) else value

    def name(self, collection: str, value: Any) -> str:
        entries = self.named.setdefault(collection, {})
        name = f"{collection}-{len(entries)}"
        entries[name] = value
        return name

    def thing(self, **fields: Any) -> Document:
        """An object without those fields that are None."""
        return {name: value for name, value in fields.items() if value is not None}

    def is_mapped(self, kernel: Any) -> bool:
        """Whether a kernel, its name or what holds one needs a surface's coordinates."""
        if isinstance(kernel, str):
            return self.is_mapped(self.named.get("kernels", {}).get(kernel, 0))
        if isinstance(kernel, list):
            return any(map(self.is_mapped, kernel))
        if not isinstance(kernel, dict):
            return False
        return bool(kernel.keys() & _ALONG) or any(
            self.is_mapped(value) for name, value in kernel.items() if name not in ("type", "asset")
        )
