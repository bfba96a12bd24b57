"""Addresses notified of how renders end and that one will miss its error, and the messages still to be sent.

A trigger notes the message in the transaction that ends the render, whoever wrote that, so none is lost and
none reports an end that did not happen.
"""

import base64
import json
import secrets
import time
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from nocturne_scene.errors import InputError, NotFound

from nocturne_coordinator.store.database import Database

MAX_WEBHOOKS = 20
"""Of one owner."""

_KEEP_SECONDS = 7 * 86400.0
_SECRET_BYTES = 32


@dataclass(frozen=True, slots=True)
class Webhook:
    """An address that is notified of how its owner's renders end."""

    id: str
    owner: str
    url: str
    created: float
    last_outcome: str
    """Of the last message, in words; empty before the first."""


@dataclass(frozen=True, slots=True)
class WebhookMessage:
    """One end, or a miss to come, to be reported to one address."""

    number: int
    webhook_id: str
    owner: str
    url: str
    secret: str
    message_id: str
    render_id: str
    name: str
    state: str
    reason: str
    error_warning: str
    """Why the image's error is not to be trusted; empty: it is."""
    event: str
    """`target_unreachable`, or empty: the render has ended."""
    unix_time: float
    attempts: int


class Webhooks:
    """The webhooks of a data folder. For many processes."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def create(self, owner: str, url: str) -> tuple[Webhook, str]:
        """Makes one, and the secret that its messages are signed with, which can't be had again.

        `url` is taken as it is: who sends checks it, each time. Raises InputError where there are too many.
        """
        secret = "whsec_" + base64.b64encode(secrets.token_bytes(_SECRET_BYTES)).decode()
        webhook = Webhook("wh-" + secrets.token_hex(8), owner, url, time.time(), "")
        with self._database.transaction():
            if len(self.list(owner)) >= MAX_WEBHOOKS:
                raise InputError.at("$.url", f"there are {MAX_WEBHOOKS} webhooks already; delete one first")
            self._database.execute(
                "INSERT INTO webhook (id, owner, url, secret, created) VALUES (?, ?, ?, ?, ?)",
                (webhook.id, owner, url, secret, webhook.created),
            )
        return webhook, secret

    def list(self, owner: str | None) -> Sequence[Webhook]:
        """An owner's, or everybody's; oldest first."""
        rows = self._database.rows(
            """SELECT id, owner, url, created, last_outcome FROM webhook
               WHERE owner = coalesce(?, owner) ORDER BY created""",
            (owner,),
        )
        return [Webhook(**dict(row)) for row in rows]

    def owner_of(self, webhook_id: str) -> str:
        """Raises NotFound."""
        row = self._database.row("SELECT owner FROM webhook WHERE id = ?", (webhook_id,))
        if row is None:
            raise NotFound(f"there is no webhook {webhook_id!r}")
        return str(row["owner"])

    def delete(self, webhook_id: str) -> None:
        """Deletes it with all messages still to be sent. Deleting again changes nothing."""
        self._database.execute("DELETE FROM webhook WHERE id = ?", (webhook_id,))

    def take_due(
        self,
        now: float,
        lease_seconds: float,
        most: int,
        of_owner: int,
        at_work: Collection[WebhookMessage] = (),
    ) -> Sequence[WebhookMessage]:
        """Messages to be sent now. Nobody else gets them for `lease_seconds`; then they are due again.

        Together with those `at_work`, one of each webhook, so many `of_owner`, and `most` in all.
        """
        if not self._database.row("SELECT 1 FROM webhook_message WHERE due <= ?", (now,)):
            return []
        with self._database.transaction():
            rows = self._database.rows(
                """SELECT number, webhook_id, owner, url, secret, message_id, render_id, name, state, reason,
                       error_warning, event, unix_time, attempts
                   FROM (
                       SELECT *, row_number() OVER (PARTITION BY webhook_id ORDER BY due, number) AS place
                       FROM webhook_message
                       WHERE due <= ?1 AND webhook_id NOT IN (SELECT value FROM json_each(?2))
                   ) AS first_due JOIN webhook ON webhook.id = webhook_id
                   WHERE place = 1 ORDER BY due, number""",
                (now, json.dumps([each.webhook_id for each in at_work])),
            )
            owners = Counter(each.owner for each in at_work)
            taken: list[WebhookMessage] = []
            for row in rows:
                if len(taken) + len(at_work) < most and owners[row["owner"]] < of_owner:
                    owners[row["owner"]] += 1
                    taken.append(WebhookMessage(**dict(row)))
            self._database.execute_many(
                "UPDATE webhook_message SET due = ? WHERE number = ?",
                [(now + lease_seconds, message.number) for message in taken],
            )
        return taken

    def settle(self, message: WebhookMessage, outcome: str, due: float | None) -> None:
        """Notes how an attempt went, and when there is to be another; None: never. Drops old messages."""
        with self._database.transaction():
            self._database.execute(
                "UPDATE webhook_message SET attempts = attempts + 1, due = ? WHERE number = ?",
                (due, message.number),
            )
            self._database.execute(
                "UPDATE webhook SET last_outcome = ? WHERE id = ?", (outcome, message.webhook_id)
            )
            self._database.execute(
                "DELETE FROM webhook_message WHERE due IS NULL AND unix_time < ?",
                (time.time() - _KEEP_SECONDS,),
            )
