"""What the compiler gives; apart from it, for those who let other processes compile."""

from dataclasses import dataclass, field

from nocturne_scene.render_warnings import RenderWarning


@dataclass(frozen=True)
class CompiledOutput:
    """Where the compiled scene is, and which parts of the document it does without, in words with their
    places.
    """

    scene_sha256: str
    dropped: list[str]
    warnings: list[RenderWarning] = field(default_factory=list)
    """Probable mistakes, in words with their places, and light that the image may not show."""
    way: str = ""
    """How it is traced and why, in words; empty where no pilot chose."""
