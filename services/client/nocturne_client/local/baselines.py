"""`nocturne baseline`: compares a render with one of the same scene by another version of the engine."""

import tempfile
from pathlib import Path

from nocturne_client.client import Client
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.comparing import Compared, Comparison, compare_files
from nocturne_client.models import Render


def compared_with_baseline(
    url: str | None, render_id: str, engine: int, difference: Path | None
) -> tuple[str, Compared]:
    """The compared renders in words, and how far both are apart. `engine`: 0 for the newest other one.

    Raises NocturneClientError.
    """
    with Client(url) as client, tempfile.TemporaryDirectory(prefix="nocturne-baseline-") as folder:
        render = client.get(render_id)
        other = _chosen([*client.baselines(render.id)], render, engine)
        one, reference = Path(folder) / "image.exr", Path(folder) / "baseline.exr"
        client.download(render.id, "exr", one)
        client.download(other.id, "exr", reference)
        told = f"{render.id} by engine {render.engine}, beside {other.id} by engine {other.engine}"
        return told, compare_files(Comparison(one, reference), difference)


def _chosen(baselines: list[Render], render: Render, engine: int) -> Render:
    found = next((each for each in baselines if engine in (0, each.engine)), None)
    if found is None:
        wanted = f"engine {engine}" if engine else f"another engine than {render.engine}"
        raise NocturneClientError(f"there is no image of the same scene and film by {wanted}")
    return found
