"""`nocturne ugr`: the tabular method of unified glare rating, of a photometric file."""

import math
from pathlib import Path
from typing import Any

from nocturne_scene.photometry import files
from nocturne_scene.photometry import ugr_table as tabular
from nocturne_scene.photometry.intensities import BadPhotometryError
from rich.table import Table

from nocturne_client.errors import NocturneClientError


def ugr_rows(file: Path, spacing: float) -> list[dict[str, Any]]:
    """A row for each room and view: x and y in heights, view, ratings by reflectances of ceiling, walls and
    floor. Raises NocturneClientError."""
    try:
        photometry = files.read(file.read_bytes())
        found = list(tabular.table(photometry, spacing))
    except OSError as error:
        raise NocturneClientError(f"{file}: {error.strerror}") from error
    except (BadPhotometryError, ValueError) as error:
        raise NocturneClientError(f"{file}: {error}") from error
    names = ["/".join(f"{100 * part:.0f}" for part in each) for each in tabular.REFLECTANCES]
    return [
        {
            "x": room.x,
            "y": room.y,
            "view": view,
            "ratings": {
                name: None if math.isnan(value) else round(value, 1)
                for name, value in zip(names, ratings, strict=True)
            },
        }
        for room, view, ratings in found
    ]


def ugr_table(file: Path, spacing: float) -> Table:
    """The same to read."""
    rows = ugr_rows(file, spacing)
    table = Table("X", "Y", "view", *rows[0]["ratings"], box=None, pad_edge=False)
    for row in rows:
        ratings = ("-" if value is None else f"{value:.1f}" for value in row["ratings"].values())
        table.add_row(f"{row['x']} H", f"{row['y']} H", row["view"], *ratings)
    return table
