"""What a coordinator does to a render, as far as the API can see it."""

from nocturne_coordinator.store.data_folder import DataFolder


def progress(folder: DataFolder, render_id: str, pixel_samples: int) -> None:
    """Commits the photons of some samples of pixels."""
    folder.database.execute(
        "UPDATE render SET state = 'RUNNING', started = created, photons = ? * photons_per_sample, "
        "sequence = sequence + 1 WHERE id = ?",
        (pixel_samples, render_id),
    )


def finish(folder: DataFolder, render_id: str) -> None:
    """Ends a render well."""
    folder.database.execute(
        "UPDATE render SET state = 'SUCCEEDED', ended = created + 1, sequence = sequence + 1 WHERE id = ?",
        (render_id,),
    )


def picture(folder: DataFolder, render_id: str, content: bytes) -> None:
    """Writes a preview."""
    path = folder.preview_path(render_id)
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_suffix(".new")
    new.write_bytes(content)
    new.replace(path)
