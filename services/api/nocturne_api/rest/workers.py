"""Workers."""

from fastapi import APIRouter
from starlette.responses import Response

from nocturne_api.rest.access import Service
from nocturne_api.views import WorkersView

router = APIRouter(prefix="/v1", tags=["workers"])


@router.get("/workers")
async def workers(operations: Service) -> WorkersView:
    """The workers heard of in the last ten seconds."""
    return WorkersView(workers=await operations.workers())


@router.post("/workers/{worker_id}:release", status_code=204, response_class=Response)
async def release_worker(worker_id: str, operations: Service) -> Response:
    """Takes the results of a worker in quarantine again."""
    await operations.release_worker(worker_id)
    return Response(status_code=204)
