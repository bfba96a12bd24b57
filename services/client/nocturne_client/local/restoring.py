"""`nocturne restore`: a data folder of this machine is put in order, and the findings are reported. `nocturne
database`: a new one has its database on a server."""

from pathlib import Path
from typing import Any

from nocturne_coordinator.store.database import DatabaseTrouble
from nocturne_coordinator.store.databases import put_on_server
from nocturne_coordinator.store.privacy import make_private
from nocturne_coordinator.store.restoring import Restored, restore

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.data import default_data_folder
from nocturne_client.local.failures import client_errors
from nocturne_client.local.up import only_one_service


def restore_folder(data: Path | None, source: Path | None) -> Restored:
    """NocturneClientError where that can't be done, or a service runs on the folder."""
    data = data or default_data_folder()
    with client_errors(f"{data} can't be restored"):
        if not data.is_dir():
            return restore(data, source)
        with only_one_service(data):
            return restore(data, source)


def database_on_server(data: Path | None, server: str) -> Path:
    """Gives the folder. NocturneClientError where the server does not answer or refuses, or the folder has
    another database."""
    data = data or default_data_folder()
    try:
        with client_errors(f"{data} can't be used"):
            data.mkdir(mode=0o700, parents=True, exist_ok=True)
            make_private(data)
            with only_one_service(data):
                put_on_server(data, server)
    except DatabaseTrouble as trouble:
        raise NocturneClientError(f"{server}: {trouble}") from trouble
    return data


def as_json(found: Restored) -> dict[str, Any]:
    """For programs."""
    return {
        "restored_from": str(found.database) if found.database else None,
        "damage": found.damage,
        "renders": found.renders,
        "open_ranges": found.open_ranges,
        "missing": found.missing,
    }


def as_lines(found: Restored) -> list[str]:
    """For people."""
    return [
        *(f"Damaged: {each}" for each in found.damage),
        f"Restored from {found.database}."
        if found.database
        else "The database is whole; nothing was replaced.",
        f"{found.renders} renders; {found.open_ranges} ranges will be traced when the service starts.",
        *(
            f"The scene of {each} is nowhere; cancel the render, or submit it again."
            for each in found.missing
        ),
    ]
