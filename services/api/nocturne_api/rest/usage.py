"""Who uses what, and what it costs."""

from fastapi import APIRouter

from nocturne_api.models.usage import Usage
from nocturne_api.rest.access import Service

router = APIRouter(prefix="/v1/usage", tags=["workers"])


@router.get("")
async def get_usage(operations: Service) -> Usage:
    """Processor time and money of each owner, deleted renders included, and its share of the workers now."""
    return await operations.usage.get()
