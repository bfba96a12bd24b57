"""Layers of renders: made by whoever serves, after the render was queued; its end waits for them."""

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from nocturne_scene.layers import CHANNELS
from nocturne_scene.render_warnings import RenderWarning, WarningKind

from nocturne_coordinator.errors import BlobsMissing
from nocturne_coordinator.store.blob_use import BlobUse
from nocturne_coordinator.store.database import Database

LAYERS_DUE = """layers <> '[]' AND layers_sha256 = ''
    AND (photons > 0 OR state IN ('QUEUED', 'RUNNING', 'PAUSED'))"""
"""Of a row of `render`: whether it has layers that are not made yet. One that ended before it had any sample
has no image that they could be in."""


@dataclass(frozen=True, slots=True)
class LayersDue:
    """The inputs for making the layers of a render."""

    render_id: str
    owner: str
    width: int
    height: int
    samples: int
    layers: tuple[str, ...]
    scene_document: str

    @property
    def size_bytes(self) -> int:
        """Of their file, at most: it is compressed."""
        return layers_bytes(self.width, self.height, self.layers)


def layers_bytes(width: int, height: int, layers: Iterable[str]) -> int:
    """What layers of a film take, before they are compressed."""
    return 4 * width * height * sum(len(CHANNELS[layer]) for layer in layers)


class RenderLayers:
    """The layers of a data folder's renders."""

    def __init__(self, database: Database, blob_here: Callable[[str], Path | None]) -> None:
        """`blob_here` gives the file of a blob, None where it is not on this machine."""
        self._database = database
        self._blob_use = BlobUse(database)
        self._blob_here = blob_here

    def due(self) -> list[tuple[str, str]]:
        """Render and owner, oldest first, of those whose layers are to be made."""
        rows = self._database.rows(f"SELECT id, owner FROM render WHERE {LAYERS_DUE} ORDER BY number")  # noqa: S608
        return [(row["id"], row["owner"]) for row in rows]

    def get_due(self, render_id: str) -> LayersDue | None:
        """None: the render is gone, or its layers are made."""
        row = self._database.row(
            f"""SELECT id AS render_id, owner, width, height, samples, layers, scene_document
                FROM render WHERE id = ? AND {LAYERS_DUE}""",  # noqa: S608
            (render_id,),
        )
        return None if row is None else LayersDue(**{**dict(row), "layers": tuple(json.loads(row["layers"]))})

    def made(self, render_id: str, sha256: str) -> None:
        """The file of a render's layers is there. Raises BlobsMissing if it was removed in the meantime."""
        with self._database.transaction():
            # Who removes files looks at renders in a transaction, too.
            if self._blob_here(sha256) is None:
                raise BlobsMissing("the file of the layers was deleted with another render")
            made = self._database.execute(
                f"UPDATE render SET layers_sha256 = ?, sequence = sequence + 1 WHERE id = ? AND {LAYERS_DUE}",  # noqa: S608
                (sha256, render_id),
            )
            if made:
                self._blob_use.note(render_id, [sha256])

    def give_up(self, render_id: str, why: str) -> None:
        """The render does without layers, and says why."""
        warning = RenderWarning(WarningKind.LAYERS, why)
        with self._database.transaction():
            row = self._database.row(
                f"SELECT warnings FROM render WHERE id = ? AND {LAYERS_DUE}",  # noqa: S608
                (render_id,),
            )
            if row is not None:
                warnings = json.dumps([*json.loads(row["warnings"]), warning.to_json()])
                self._database.execute(
                    """UPDATE render SET layers = '[]', warnings = ?, sequence = sequence + 1 WHERE id = ?""",
                    (warnings, render_id),
                )
