"""Addresses that are told how renders end."""

from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict, Field
from starlette.responses import Response

from nocturne_api.limits import SMALL_BODY_BYTES
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import read_json
from nocturne_api.rest.renders import body_of
from nocturne_api.views import NewWebhookView, WebhooksView

router = APIRouter(prefix="/v1/webhooks", tags=["webhooks"])


class WebhookBody(BaseModel):
    """An address to tell."""

    model_config = ConfigDict(extra="forbid", strict=True)

    url: str = Field(description="https, and a public address.")


@router.post("", status_code=201, openapi_extra=body_of(WebhookBody))
async def create_webhook(request: Request, operations: Service) -> NewWebhookView:
    """Tells an address how the caller's renders end, in signed messages (standardwebhooks.com)."""
    body = await read_json(request, WebhookBody, SMALL_BODY_BYTES)
    return await operations.create_webhook(body.url)


@router.get("")
async def list_webhooks(operations: Service) -> WebhooksView:
    """The caller's; everybody's for admins."""
    return WebhooksView(webhooks=await operations.list_webhooks())


@router.delete("/{webhook_id}", status_code=204, response_class=Response)
async def delete_webhook(webhook_id: str, operations: Service) -> Response:
    """Tells it nothing more."""
    await operations.delete_webhook(webhook_id)
    return Response(status_code=204)
