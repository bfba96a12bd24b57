"""Workers."""

from fastapi import APIRouter
from nocturne_scene.errors import NotFound
from starlette.responses import Response

from nocturne_api.models.workers import WorkerHistory, WorkerList, WorkList
from nocturne_api.rest.access import Service
from nocturne_api.rest.contract import errors

router = APIRouter(prefix="/v1/workers", tags=["workers"])


@router.get("")
async def list_workers(operations: Service) -> WorkerList:
    """The workers heard of in the last ten seconds."""
    return await operations.workers.list()


@router.get("/work")
async def get_work(operations: Service) -> WorkList:
    """Which renders the workers are tracing, and since when."""
    return await operations.workers.work()


@router.get("/history")
async def get_worker_history(operations: Service) -> WorkerHistory:
    """Worker events (joined, left, quarantined, draining, released) and the workers' rate by the minute."""
    return await operations.workers.history()


@router.post("/{worker_id}:drain", status_code=204, response_class=Response, responses=errors(NotFound))
async def drain_worker(worker_id: str, operations: Service) -> Response:
    """Gives a worker no more jobs; it finishes those that it has."""
    await operations.workers.drain(worker_id)
    return Response(status_code=204)


@router.post("/{worker_id}:release", status_code=204, response_class=Response, responses=errors(NotFound))
async def release_worker(worker_id: str, operations: Service) -> Response:
    """Gives a worker in quarantine, or a drained one, jobs again, and takes its results."""
    await operations.workers.release(worker_id)
    return Response(status_code=204)
