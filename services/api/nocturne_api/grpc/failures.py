"""Every error of the gRPC endpoint: a status, a message, and the same problem details as in REST."""

import json
from types import TracebackType
from typing import Any

import grpc

from nocturne_api.errors import Failure, failure_of

# Trailing metadata with the problem as UTF-8 JSON: {"reason", "detail", "problems": [{"place", "message"}]}.
PROBLEM_KEY = "nocturne-problem-bin"
# Seconds after which the same may succeed, as in REST's Retry-After.
RETRY_KEY = "retry-after"
# Metadata of one answer must stay below 8 KiB, and the message travels in it too.
_PROBLEM_BYTES = 4096


class Answering:
    """`async with Answering(context)`: an error inside ends the call with the status of its class."""

    def __init__(self, context: grpc.aio.ServicerContext[Any, Any]) -> None:
        self._context = context

    async def __aenter__(self) -> None:
        pass

    async def __aexit__(
        self, _: type[BaseException] | None, error: BaseException | None, __: TracebackType | None
    ) -> None:
        if isinstance(error, Exception) and not isinstance(error, grpc.aio.AbortError):
            failure = failure_of(error)
            trailer: list[tuple[str, str | bytes]] = [(PROBLEM_KEY, _encoded(failure))]
            if failure.kind.retry_after_s:
                trailer.append((RETRY_KEY, str(failure.kind.retry_after_s)))
            await self._context.abort(failure.kind.grpc_status, failure.detail, tuple(trailer))


def _encoded(failure: Failure) -> bytes:
    problems = [{"place": each.place, "message": each.message} for each in failure.problems]
    while True:
        problem = {"reason": failure.kind.reason, "detail": failure.detail, "problems": problems}
        text = json.dumps(problem, ensure_ascii=False).encode("utf-8", "replace")
        if len(text) <= _PROBLEM_BYTES:
            return text
        problems.pop()
