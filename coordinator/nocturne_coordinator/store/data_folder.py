"""One folder that holds everything worth keeping: renders, committed sums, blobs, images.

    nocturne.db      renders, tiles, workers (SQLite in WAL mode), or
    postgresql       where they are on a server instead (see databases.py)
    blobs/           scenes and assets by SHA-256
    images/<id>/     preview.png, thumbnail.png and image.exr of a render, failed-tile-<tile>.zip
    checkpoints/     the last two copies of the database (see checkpoint.py)
    coordinator.lock held by the coordinator that works on the folder
    coordinator.starting held for the moment in which one comes

The API and the coordinator open it at the same time; only the coordinator's `store.ledger` writes sums.
"""

from pathlib import Path

from nocturne_scene.blobs import BlobStore
from nocturne_scene.replacing import sync

from nocturne_coordinator.errors import UnusableFolder
from nocturne_coordinator.store.archive import Archive
from nocturne_coordinator.store.blob_use import BlobUse, Removals
from nocturne_coordinator.store.calls import Calls
from nocturne_coordinator.store.database import DatabaseTrouble
from nocturne_coordinator.store.databases import open_database
from nocturne_coordinator.store.layers import RenderLayers
from nocturne_coordinator.store.machines import Machines
from nocturne_coordinator.store.measured_regions import MeasuredRegions
from nocturne_coordinator.store.meters import Meters
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.privacy import make_private
from nocturne_coordinator.store.quotas import Uploads
from nocturne_coordinator.store.render_requests import RenderRequests
from nocturne_coordinator.store.renders import Renders
from nocturne_coordinator.store.sessions import Sessions
from nocturne_coordinator.store.tiles import Tiles
from nocturne_coordinator.store.tokens import Tokens
from nocturne_coordinator.store.webhooks import Webhooks
from nocturne_coordinator.store.workers import Workers


class DataFolder:
    """Opens, or creates, the folder. Safe for many threads and processes; calls take milliseconds."""

    def __init__(self, path: Path, objects: ObjectStore | None = None) -> None:
        """`objects` keeps blobs too.

        Raises UnusableFolder if another version wrote it, it is damaged, it can't be written, it is another
        user's, or only checkpoints are left.
        """
        self.root = path
        try:
            _make(path)
            self.database = open_database(path)
            self.object_store = objects
            self.blobs = BlobStore(path / "blobs", objects)
            sync(path)
        except (OSError, DatabaseTrouble) as trouble:
            raise UnusableFolder.because(path, trouble) from trouble
        self.tiles = Tiles(self.database)
        self.blob_use = BlobUse(self.database)
        self.renders = Renders(self.database, self.blobs.here)
        self.requests = RenderRequests(self.database, self.renders, self.tiles)
        self.layers = RenderLayers(self.database, self.blobs.here)
        self.workers = Workers(self.database)
        self.machines = Machines(self.database)
        self.measured_regions = MeasuredRegions(self.database)
        self.meters = Meters(self.database)
        self.calls = Calls(self.database)
        self.tokens = Tokens(self.database)
        self.sessions = Sessions(self.database, self.tokens)
        self.archive = Archive(self.database)
        self.webhooks = Webhooks(self.database)
        self.removals = Removals(self.database)
        self.uploads = Uploads(self.database)

    def close(self) -> None:
        self.database.close()

    def check_place(self) -> None:
        """Raises FolderGone where the folder was moved away, or another one is in its place."""
        self.database.check_place()

    def preview_path(self, render_id: str) -> Path:
        """The PNG; may not exist yet."""
        return self._images(render_id) / "preview.png"

    def thumbnail_path(self, render_id: str) -> Path:
        """The small PNG; may not exist yet."""
        return self._images(render_id) / "thumbnail.png"

    def image_path(self, render_id: str) -> Path:
        """The EXR; may not exist yet."""
        return self._images(render_id) / "image.exr"

    def bundle_path(self, render_id: str, tile_index: int) -> Path:
        """The files needed to reproduce a tile's failure; may not exist."""
        return self._images(render_id) / f"failed-tile-{tile_index}.zip"

    def _images(self, render_id: str) -> Path:
        # The id becomes part of a path: only one that this folder gave out may.
        self.renders.get(render_id)
        return self.root / "images" / render_id

    def change_counter(self) -> int:
        """Another number whenever anything in the folder's database changed; cheap enough to ask often."""
        return self.database.change_counter()


def make_folders(image: Path) -> None:
    """The folders of an image, but not the data folder: one that was moved away must not be created again."""
    for each in (image.parent.parent, image.parent):
        each.mkdir(exist_ok=True)


def _make(path: Path) -> None:
    """Makes the folder and those above it, with their names on the disk; other users can't enter."""
    missing = [each for each in (path, *path.parents) if not each.exists()]
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    for each in missing:
        sync(each.parent)
    make_private(path)
