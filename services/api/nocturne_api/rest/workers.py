"""Workers."""

from fastapi import APIRouter

from nocturne_api.rest.access import Service
from nocturne_api.views import WorkersView

router = APIRouter(prefix="/v1", tags=["workers"])


@router.get("/workers")
async def workers(operations: Service) -> WorkersView:
    """The workers heard of in the last ten seconds."""
    return WorkersView(workers=await operations.workers())
