"""Parts of images that people measure, kept with their renders."""

import json
from collections.abc import Sequence

from nocturne_scene.photometry.outlines import Outline

from nocturne_coordinator.store.database import Database

NamedOutline = tuple[str, Outline]


class MeasuredRegions:
    """The measured regions of a data folder, by render. For many processes."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def of(self, render_id: str) -> list[NamedOutline]:
        """In the order in which they were given; none where there are none."""
        row = self._database.row("SELECT regions FROM measured_region WHERE render_id = ?", (render_id,))
        return [
            (each["name"], Outline(each["kind"], tuple((x, y) for x, y in each["points"])))
            for each in json.loads(row["regions"] if row else "[]")
        ]

    def keep(self, render_id: str, regions: Sequence[NamedOutline]) -> None:
        """Instead of all that were there."""
        content = [
            {"name": name, "kind": outline.kind, "points": outline.points} for name, outline in regions
        ]
        self._database.execute(
            """INSERT INTO measured_region VALUES (?, ?)
               ON CONFLICT (render_id) DO UPDATE SET regions = excluded.regions""",
            (render_id, json.dumps(content, separators=(",", ":"))),
        )
