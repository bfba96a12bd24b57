"""Parts of a scene that are not supported, for the person who renders it."""


class Findings:
    """Sentences, each once."""

    def __init__(self) -> None:
        self.sentences: list[str] = []

    def lost(self, name: str, what: str) -> None:
        """`name`: the object, material or light in Blender."""
        sentence = f"{name}: {what}"
        if sentence not in self.sentences:
            self.sentences.append(sentence)
