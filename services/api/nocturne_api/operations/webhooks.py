"""Webhooks: addresses that are notified of how renders end."""

from dataclasses import asdict

from nocturne_api import limits
from nocturne_api.access import CALLER
from nocturne_api.models.webhooks import NewWebhook, Webhook, WebhookList
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.webhooks.targets import TargetRules


class Webhooks:
    """The webhooks of one data folder, each its owner's."""

    def __init__(self, access: FolderAccess, rules: TargetRules) -> None:
        self._access = access
        self._rules = rules
        self._webhooks = access.folder.webhooks

    async def create(self, url: str) -> NewWebhook:
        """Tells `url` how the caller's renders end. Raises InputError for an address that is not allowed."""
        async with self._access.recorded("create webhook"):
            CALLER.get().need("submit")
            self._rules.admit(url)
            owner = CALLER.get().name
            webhook, secret = await self._access.writing(self._webhooks.create, owner, url)
            return NewWebhook(secret=secret, **asdict(webhook))

    async def list(self) -> WebhookList:
        """The caller's, oldest first; an admin gets everybody's."""
        caller = CALLER.get()
        caller.need("submit")
        owner = None if "admin" in caller.scopes else caller.name
        found = await self._access.in_database(self._webhooks.list, owner)
        return WebhookList(webhooks=[Webhook.of(each) for each in found])

    async def delete(self, webhook_id: str) -> None:
        """Tells it nothing more. Raises NotFound."""
        async with self._access.recorded(f"delete webhook {webhook_id[: limits.RECORDED_CHARACTERS]}"):
            CALLER.get().need_own(await self._access.in_database(self._webhooks.owner_of, webhook_id))
            await self._access.writing(self._webhooks.delete, webhook_id)
