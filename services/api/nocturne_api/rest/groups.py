"""Groups of renders."""

from fastapi import APIRouter
from nocturne_scene.errors import NotFound

from nocturne_api.models.groups import Group
from nocturne_api.rest.access import Service
from nocturne_api.rest.contract import errors

router = APIRouter(prefix="/v1/groups", tags=["renders"])


@router.get("/{name}", responses=errors(NotFound))
async def get_group(name: str, operations: Service) -> Group:
    """Renders that were submitted together, as one; `GET /v1/renders?group=NAME` lists them."""
    return await operations.groups.get(name)
