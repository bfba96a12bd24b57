"""Which database a data folder has: the file `nocturne.db` in it, or a server that the folder names.

    postgresql       a connection string of libpq, without a password: postgresql://nocturne@db.site/nocturne
    postgresql.id    the `folder` of that database, so that the two are never of different services

So every program that opens the folder has the same one. Passwords come as for all clients of PostgreSQL, from
~/.pgpass, PGPASSWORD or a certificate.
"""

from pathlib import Path

from nocturne_scene.replacing import replacing

from nocturne_coordinator.errors import UnusableFolder
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.sqlite import SqliteDatabase

_SERVER, _ID = "postgresql", "postgresql.id"


def open_database(root: Path) -> Database:
    """The folder's, made if it isn't there. Raises UnusableFolder, DatabaseTrouble and OSError."""
    server = server_of(root)
    if server:
        return _on_server(root, server)
    path = root / "nocturne.db"
    if not path.exists() and any((root / "checkpoints").glob("*.json")):
        raise UnusableFolder(f"{path} is gone; run nocturne restore")
    return SqliteDatabase(path)


def server_of(root: Path) -> str:
    """Where the folder's database is; empty: in the folder."""
    try:
        return (root / _SERVER).read_text(encoding="utf-8").strip()
    except FileNotFoundError:
        return ""


def put_on_server(root: Path, server: str) -> None:
    """From here on a folder without a database has one on this server, which is made if it isn't there. The
    same server again changes nothing. Raises UnusableFolder, DatabaseTrouble and OSError."""
    if (root / "nocturne.db").exists():
        raise UnusableFolder(f"{root} has its database in nocturne.db already; give another folder")
    before = server_of(root)
    if before not in ("", server):
        raise UnusableFolder(f"{root} has its database on {before!r}")
    _on_server(root, server).close()
    _write(root / _SERVER, server)


def open_restored(root: Path) -> Database:
    """That on the folder's server, whichever folder it belonged to; `write_id` makes them belong together."""
    return _connect(root, server_of(root))


def write_id(root: Path, folder: str) -> None:
    """The folder belongs to the database whose `folder` this is."""
    _write(root / _ID, folder)


def _connect(root: Path, server: str) -> Database:
    try:
        from nocturne_coordinator.store.postgresql import PostgresDatabase
    except ImportError:
        raise UnusableFolder(
            f"the database of {root} is on PostgreSQL, for which psycopg is missing: install "
            "nocturne[postgresql]"
        ) from None
    return PostgresDatabase(root, server)


def _on_server(root: Path, server: str) -> Database:
    database = _connect(root, server)
    try:
        row = database.row("SELECT folder FROM ownership")
        folder = str(row["folder"]) if row is not None else ""
        known = root / _ID
        if not known.exists():
            write_id(root, folder)
        elif known.read_text(encoding="utf-8").strip() != folder:
            raise UnusableFolder(
                f"{root} belongs to another database than that on its server; give the folder that belongs "
                "to it, or run nocturne restore if a backup was brought back"
            )
    except BaseException:
        database.close()
        raise
    return database


def _write(path: Path, text: str) -> None:
    with replacing(path, durable=True) as unfinished:
        unfinished.write_text(f"{text}\n", encoding="utf-8")
