"""Machines that work for the service."""

from nocturne_coordinator.enrolment import redis_password, redis_user
from nocturne_scene.errors import InputError

from nocturne_api.access import CALLER
from nocturne_api.models.machines import Enrolment
from nocturne_api.operations.folder_access import FolderAccess


class Machines:
    """Those of one data folder, each known by a token."""

    def __init__(self, access: FolderAccess) -> None:
        self._access = access

    async def enrol(self) -> Enrolment:
        """Makes the caller's machine one of the service's, or tells it again what it was told. Raises
        InputError."""
        caller = CALLER.get()
        caller.need("worker")
        if not caller.name:
            raise InputError.at("token", "a machine enrols with a token of its own")
        async with self._access.recorded(f"enrol {caller.name}"):
            key = await self._access.in_database(self._access.folder.machines.enrol, caller.name)
        return Enrolment(
            machine=caller.name,
            key=key,
            redis_user=redis_user(caller.name),
            redis_password=redis_password(key),
        )
