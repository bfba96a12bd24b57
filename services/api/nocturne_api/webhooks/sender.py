"""Tells webhooks how renders ended, and that one will miss its error: Standard Webhooks messages, sent until
one is taken or it is too late.

The specification is at standardwebhooks.com; schedule and treatment of answers are its recommendations.
"""

import asyncio
import json
import logging
import random
import ssl
import time
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from datetime import UTC, datetime

import httpx
from nocturne_coordinator.store.webhooks import WebhookMessage, Webhooks
from nocturne_scene.errors import InputError
from standardwebhooks import Webhook as Signer

from nocturne_api.background.task import Background
from nocturne_api.webhooks.targets import TargetRefused, TargetRules

_log = logging.getLogger(__name__)

PAUSES_S = (5.0, 300.0, 1800.0, 7200.0, 18000.0, 36000.0, 50400.0, 72000.0, 86400.0)
"""After the first attempt, the second and so on; each up to a fifth longer, so that not all come at once."""

_LOOK_S = 1.0
_TIMEOUT_S = 15.0
# One to each address at a time, and so many of one owner: only owners whose addresses take no messages
# wait.
_AT_ONCE = 64
_OF_OWNER = 4
_GONE = 410


class WebhookSender(Background):
    """Looks for messages that are due, and sends them. One for each API process; they share the work."""

    def __init__(
        self,
        webhooks: Webhooks,
        in_database: Callable[..., Awaitable[object]],
        rules: TargetRules,
        pauses_s: tuple[float, ...] = PAUSES_S,
        verify: ssl.SSLContext | bool = True,
    ) -> None:
        """`in_database` runs a call where the data folder's calls run."""
        self._webhooks = webhooks
        self._in_database = in_database
        self._rules = rules
        self._pauses_s = pauses_s
        self._verify = verify
        self._opened: httpx.AsyncClient | None = None
        self._at_work: set[WebhookMessage] = set()
        self._ended = asyncio.Event()

    async def close(self) -> None:
        """Messages being sent are cut off, and sent again later, perhaps by another process."""
        await super().close()
        if self._opened is not None:
            await self._opened.aclose()

    @property
    def _http(self) -> httpx.AsyncClient:
        """Made for the first message, as it reads the certificates of all authorities.

        Straight to the address that was checked: no proxy of the environment, and never a redirect.
        """
        if self._opened is None:
            self._opened = httpx.AsyncClient(
                verify=self._verify, trust_env=False, follow_redirects=False, timeout=_TIMEOUT_S
            )
        return self._opened

    async def _run(self) -> None:
        async with asyncio.TaskGroup() as group:
            while True:
                self._ended.clear()
                try:
                    for message in await self._take():
                        self._at_work.add(message)
                        group.create_task(self._send(message))
                except Exception:
                    _log.exception("webhooks: will look again")
                # Not by `wait_for`, which may forget that it was cancelled if the awaited result comes then.
                with suppress(TimeoutError):
                    async with asyncio.timeout(_LOOK_S):
                        await self._ended.wait()

    async def _take(self) -> Sequence[WebhookMessage]:
        bounds = 4 * _TIMEOUT_S, _AT_ONCE, _OF_OWNER
        found = await self._in_database(self._webhooks.take_due, time.time(), *bounds, [*self._at_work])
        assert isinstance(found, list)  # noqa: S101 - what take_due gives
        return found

    async def _send(self, message: WebhookMessage) -> None:
        try:
            await self._deliver(message)
        except Exception:
            # It is due again when its lease ends.
            _log.exception("webhook %s, render %s: again later", message.webhook_id, message.render_id)
        self._at_work.discard(message)
        self._ended.set()

    async def _deliver(self, message: WebhookMessage) -> None:
        status, outcome = await self._attempt(message)
        due: float | None = None
        if status is not None and 200 <= status < 300:
            level = logging.INFO
        elif status == _GONE:
            level = logging.WARNING
            outcome += "; its receiver does not want it any more, and it is deleted"
        else:
            level = logging.WARNING
            if message.attempts < len(self._pauses_s):
                pause = self._pauses_s[message.attempts] * random.uniform(1.0, 1.2)  # noqa: S311 - not a secret
                due = time.time() + pause
                outcome += f"; again in {pause:.0f} s"
            else:
                outcome += "; given up"
        # Neither the secret nor the address, whose query may be one.
        _log.log(level, "webhook %s, render %s: %s", message.webhook_id, message.render_id, outcome)
        await self._in_database(self._webhooks.settle, message, outcome, due)
        if status == _GONE:
            await self._in_database(self._webhooks.delete, message.webhook_id)

    async def _attempt(self, message: WebhookMessage) -> tuple[int | None, str]:
        """The status of the answer, None where there was none, and how it went in words."""
        try:
            async with asyncio.timeout(2 * _TIMEOUT_S):
                target = self._rules.parse(message.url)
                address = await self._rules.address(target)
                url = httpx.URL(message.url)
                request = self._http.build_request(
                    "POST",
                    url.copy_with(host=address),
                    content=body_of(message),
                    headers={"Host": url.netloc.decode("ascii"), **headers_of(message, time.time())},
                    # The certificate is that of the name.
                    extensions={"sni_hostname": target.host},
                )
                response = await self._http.send(request, stream=True)
                # What the receiver has to say is of no use here, and may be long.
                await response.aclose()
        except (TargetRefused, InputError) as error:
            return None, str(error)
        except (httpx.HTTPError, httpx.InvalidURL, TimeoutError) as error:
            return None, f"no answer: {type(error).__name__}"
        return response.status_code, f"answered {response.status_code}"


def body_of(message: WebhookMessage) -> bytes:
    """The same for each attempt."""
    content = {
        "type": f"render.{message.event or message.state.lower()}",
        "timestamp": datetime.fromtimestamp(message.unix_time, UTC).isoformat().replace("+00:00", "Z"),
        "data": {
            "id": message.render_id,
            "name": message.name,
            "state": message.state,
            "reason": message.reason,
            "error_warning": message.error_warning,
        },
    }
    return json.dumps(content, separators=(",", ":"), ensure_ascii=False).encode("utf-8", "replace")


def headers_of(message: WebhookMessage, now: float) -> dict[str, str]:
    """Signed at the time of the attempt, for receivers refuse old ones."""
    signer = Signer(message.secret)
    at = datetime.fromtimestamp(int(now), UTC)
    return {
        "Content-Type": "application/json",
        "User-Agent": "nocturne",
        "webhook-id": message.message_id,
        "webhook-timestamp": str(int(now)),
        "webhook-signature": signer.sign(message.message_id, at, body_of(message).decode()),
    }
