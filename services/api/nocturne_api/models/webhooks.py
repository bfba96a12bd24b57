"""Webhooks: addresses that get a message when renders end."""

from dataclasses import asdict
from typing import Self

from nocturne_coordinator.store import webhooks
from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer, RequestBody


class Webhook(Answer):
    """An address that gets a message when a render of its owner ends."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.WEBHOOK]})

    id: str
    owner: str = Field(description="Name of the token that made it; empty without authentication.")
    url: str
    created: float = Field(description="Unix time, seconds.")
    last_outcome: str = Field(description="How the last message went, in words; empty before the first.")

    @classmethod
    def of(cls, webhook: webhooks.Webhook) -> Self:
        """The public side of a row of the data folder."""
        return cls(**asdict(webhook))


class NewWebhook(Webhook):
    """A webhook with its secret, which no other answer has."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.NEW_WEBHOOK]})

    secret: str = Field(description="What messages are signed with, by standardwebhooks.com.")


class WebhookList(Answer):
    """Webhooks, oldest first."""

    webhooks: list[Webhook]


class CreateWebhookRequest(RequestBody):
    """The address of a new webhook."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"url": "https://example.org/nocturne"}]})

    url: str = Field(description="https, and a public address.")
