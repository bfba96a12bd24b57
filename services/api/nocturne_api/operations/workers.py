"""Workers: who is there, draining them, the machines that they run on, and who uses them."""

from nocturne_coordinator.dispatch.profiles import unaudited
from nocturne_coordinator.enrolment import machine_of, reason_of, redis_password, redis_user
from nocturne_coordinator.store.usage import UsageOfOwners
from nocturne_scene.errors import InputError

from nocturne_api import limits
from nocturne_api.access import CALLER
from nocturne_api.models.workers import (
    CoreHourPrice,
    Enrolment,
    OwnerUsage,
    Usage,
    Worker,
    WorkerHistory,
    WorkerList,
    WorkList,
    WorkOfWorker,
)
from nocturne_api.operations.folder_access import FolderAccess


class Workers:
    """The workers that the coordinators of the data folder heard of."""

    def __init__(self, access: FolderAccess) -> None:
        self._access = access
        self._folder = access.folder

    async def list(self) -> WorkerList:
        """Workers heard of in the last ten seconds."""
        CALLER.get().need("read")
        folder = self._folder
        rows, quarantined, incompatible, drained = await self._access.in_database(
            lambda: (
                folder.workers.alive(),
                folder.workers.in_quarantine(),
                folder.workers.incompatible(),
                folder.workers.drained(),
            )
        )
        alone = unaudited(rows, quarantined)
        words = {worker: "drained" if done else "draining" for worker, done in drained.items()}
        return WorkerList(
            workers=[
                Worker.of(
                    row,
                    reason_of(machine_of(row.id), quarantined),
                    incompatible.get(row.id, ""),
                    words.get(row.id, ""),
                    alone.get(row.id, ""),
                )
                for row in rows
            ]
        )

    async def work(self) -> WorkList:
        """Which renders, of those that the caller may see, the workers are tracing."""
        caller = CALLER.get()
        caller.need("read")
        rows = await self._access.in_database(self._folder.tiles.work_of_workers, caller.sees)
        return WorkList(
            work=[
                WorkOfWorker(worker=worker, render=render, name=name, tiles=tiles, since=since)
                for worker, render, name, tiles, since in rows
            ]
        )

    async def history(self) -> WorkerHistory:
        """Worker events of late, and the rate of all workers by the minute."""
        CALLER.get().need("read")
        events, rates = await self._access.in_database(self._folder.workers.history, limits.EVENTS_SHOWN)
        return WorkerHistory.model_validate({"events": events, "rates": rates})

    async def drain(self, worker_id: str) -> None:
        """Gives a worker no more jobs; those that it has are finished and count. Raises NotFound."""
        async with self._access.recorded(f"drain {worker_id[:80]}"):
            caller = CALLER.get()
            caller.need("admin")
            await self._access.writing(self._folder.workers.drain, worker_id, caller.name)

    async def release(self, worker_id: str) -> None:
        """Gives a worker in quarantine, or a drained one, jobs again; raises NotFound."""
        async with self._access.recorded(f"release {worker_id[:80]}"):
            CALLER.get().need("admin")
            await self._access.writing(self._folder.workers.release, worker_id)


class Machines:
    """Those of one data folder, known by a token and below it by the names of nodes."""

    def __init__(self, access: FolderAccess) -> None:
        self._access = access

    async def enrol(self, node: str) -> Enrolment:
        """Makes the caller's machine one of the service's, or gives the same answer as before; `node` tells
        apart those that have one token. Raises InputError."""
        caller = CALLER.get()
        caller.need("worker")
        if not caller.name:
            raise InputError.at("token", "a machine enrols with a token of its own")
        async with self._access.recorded(f"enrol {caller.name} {node[:80]}".rstrip()):
            machine, key = await self._access.writing(self._access.folder.machines.enrol, caller.name, node)
        return Enrolment(
            machine=machine,
            key=key,
            redis_user=redis_user(machine),
            redis_password=redis_password(key),
        )


class UsageReports:
    """The usage of one data folder."""

    def __init__(self, access: FolderAccess, price: CoreHourPrice) -> None:
        self._access = access
        self._price = price
        self._rows = UsageOfOwners(access.folder.database)

    async def get(self) -> Usage:
        """Of the caller, or of everybody for who may see all renders."""
        caller = CALLER.get()
        caller.need("read")
        rows, jobs = await self._access.in_database(self._rows.read, caller.sees)
        return Usage(
            core_hour_price=self._price.price,
            currency=self._price.currency,
            owners=[OwnerUsage.of(row, jobs, self._price) for row in rows],
        )
