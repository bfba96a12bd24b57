"""Workers."""

from fastapi import APIRouter
from starlette.responses import Response

from nocturne_api.rest.access import Service
from nocturne_api.views import WorkerHistoryView, WorkersView

router = APIRouter(prefix="/v1", tags=["workers"])


@router.get("/workers")
async def workers(operations: Service) -> WorkersView:
    """The workers heard of in the last ten seconds."""
    return WorkersView(workers=await operations.workers())


@router.get("/workers/history")
async def worker_history(operations: Service) -> WorkerHistoryView:
    """Who joined, left or was put in quarantine lately, and what all workers did, minute by minute."""
    return await operations.worker_history()


@router.post("/workers/{worker_id}:release", status_code=204, response_class=Response)
async def release_worker(worker_id: str, operations: Service) -> Response:
    """Takes the results of a worker in quarantine again."""
    await operations.release_worker(worker_id)
    return Response(status_code=204)
