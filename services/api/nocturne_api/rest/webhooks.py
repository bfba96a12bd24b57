"""Webhooks."""

from fastapi import APIRouter, Request
from nocturne_scene.errors import NotFound
from starlette.responses import Response

from nocturne_api.limits import SMALL_BODY_BYTES
from nocturne_api.models.webhooks import CreateWebhookRequest, NewWebhook, WebhookList
from nocturne_api.rest.contract import body_of, errors
from nocturne_api.rest.requests import Service, read_json

router = APIRouter(prefix="/v1/webhooks", tags=["webhooks"])


@router.post("", status_code=201, openapi_extra=body_of(CreateWebhookRequest))
async def create_webhook(request: Request, operations: Service) -> NewWebhook:
    """Tells an address how the caller's renders end, in signed messages (standardwebhooks.com)."""
    body = await read_json(request, CreateWebhookRequest, SMALL_BODY_BYTES)
    return await operations.webhooks.create(body.url)


@router.get("")
async def list_webhooks(operations: Service) -> WebhookList:
    """The caller's; everybody's for admins."""
    return await operations.webhooks.list()


@router.delete("/{webhook_id}", status_code=204, response_class=Response, responses=errors(NotFound))
async def delete_webhook(webhook_id: str, operations: Service) -> Response:
    """Deletes a webhook: its address gets no more messages."""
    await operations.webhooks.delete(webhook_id)
    return Response(status_code=204)
