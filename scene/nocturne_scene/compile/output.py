"""What the compiler gives; apart from it, for those who let other processes compile."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from google.protobuf.message import Message

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
    blobs: tuple[str, ...] = ()
    """Digests of the compiled scene and of all files that it names."""


def blobs_named_in(message: Message) -> Iterator[str]:
    """Digests of the files that a compiled scene names, or a part of it."""
    for about, value in message.ListFields():
        if about.name == "blob":
            yield value.hex()
        elif about.message_type is not None:
            for each in (value,) if isinstance(value, Message) else value:
                yield from blobs_named_in(each)
