"""Workers, and who uses them."""

from fastapi import APIRouter
from nocturne_scene.errors import NotFound
from starlette.responses import Response

from nocturne_api.models.workers import Usage, WorkerHistory, WorkerList, WorkList
from nocturne_api.rest.contract import errors
from nocturne_api.rest.requests import Service

router = APIRouter(prefix="/v1", tags=["workers"])


@router.get("/workers")
async def list_workers(operations: Service) -> WorkerList:
    """The workers heard of in the last ten seconds."""
    return await operations.workers.list()


@router.get("/workers/work")
async def get_work(operations: Service) -> WorkList:
    """Which renders the workers are tracing, and since when."""
    return await operations.workers.work()


@router.get("/workers/history")
async def get_worker_history(operations: Service) -> WorkerHistory:
    """Worker events (joined, left, quarantined, draining, released) and the workers' rate by the minute."""
    return await operations.workers.history()


@router.post(
    "/workers/{worker_id}:drain", status_code=204, response_class=Response, responses=errors(NotFound)
)
async def drain_worker(worker_id: str, operations: Service) -> Response:
    """Gives a worker no more jobs; it finishes those that it has."""
    await operations.workers.drain(worker_id)
    return Response(status_code=204)


@router.post(
    "/workers/{worker_id}:release", status_code=204, response_class=Response, responses=errors(NotFound)
)
async def release_worker(worker_id: str, operations: Service) -> Response:
    """Gives a worker in quarantine, or a drained one, jobs again, and takes its results."""
    await operations.workers.release(worker_id)
    return Response(status_code=204)


@router.get("/usage")
async def get_usage(operations: Service) -> Usage:
    """Processor time and money of each owner, deleted renders included, and its share of the workers now."""
    return await operations.usage.get()
