"""HTTP to one service: its address, token and certificates, requests tried again, and errors in one form."""

import json
import math
import os
import ssl
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, TypeVar

import httpx

from nocturne_client.errors import NocturneClientError, NotReachedError, Problem

DEFAULT_URL = "http://127.0.0.1:7070"
RETRY_DELAYS_S = (0.2, 0.5, 1.0)
# As long as the service may ask for thrice: it says 60 s where a quota is used up.
PATIENCE_S = 180.0

_TIMEOUT = httpx.Timeout(60.0, connect=5.0)
_T = TypeVar("_T")

OnWait = Callable[[NocturneClientError, float], None]
"""Gets why the service can't do it now, and the seconds after which it is asked again."""


class Transport:
    """Requests to one service. Every method raises NocturneClientError, and nothing else."""

    def __init__(
        self,
        url: str | None,
        transport: httpx.BaseTransport | None,
        token: str | None,
        patience_s: float = PATIENCE_S,
        on_wait: OnWait | None = None,
    ) -> None:
        """`patience_s`: how long one call may wait in all; `on_wait` hears of waits that the service asks
        for."""
        self.patience_s = patience_s
        self._on_wait = on_wait
        self.url = (url or os.environ.get("NOCTURNE_URL") or DEFAULT_URL).rstrip("/")
        token = token or os.environ.get("NOCTURNE_TOKEN")
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        try:
            self._http = httpx.Client(
                base_url=self.url,
                timeout=_TIMEOUT,
                transport=transport,
                trust_env=False,
                headers=headers,
                verify=_trusted(self.url),
            )
        except httpx.InvalidURL as error:
            raise NocturneClientError(f"{self.url!r} is not an address: {error}") from error

    def close(self) -> None:
        """Lets go of the connections."""
        self._http.close()

    def send(self, method: str, path: str, **arguments: Any) -> httpx.Response:
        """One request, sent once; `arguments` are those of httpx."""
        with self.stream(method, path, **arguments) as response:
            response.read()
        return response

    @contextmanager
    def stream(self, method: str, path: str, **arguments: Any) -> Iterator[httpx.Response]:
        """One request, sent once, whose answer is read piece by piece."""
        try:
            with self._http.stream(method, path, **arguments) as response:
                _raise_for(response)
                yield response
        except httpx.TransportError as error:
            raise NotReachedError(
                f"no answer from {self.url} ({error}). Start a service with `nocturne up`, or say where "
                "it is with --url or NOCTURNE_URL."
            ) from error

    def send_json(self, method: str, path: str, body: Any, **arguments: Any) -> Any:
        """A request and its answer, both in JSON, sent once."""
        # Not httpx's own encoding: NaN must reach the service, which says where in the scene it stands.
        content, headers = json.dumps(body).encode(), {"Content-Type": "application/json"}
        return self.send(method, path, content=content, headers=headers, **arguments).json()

    def get(self, path: str, params: dict[str, Any] | None = None) -> Any:
        """The resource there, in JSON."""
        return self.retrying(partial(self.send, "GET", path, params=params)).json()

    def post(self, path: str, body: Any) -> Any:
        """The answer to a request that is safe to repeat, both in JSON."""
        return self.retrying(partial(self.send_json, "POST", path, body))

    def retrying(self, call: Callable[[], _T]) -> _T:
        """Calls again, after a while, as long as the service was not reached or said that it is busy."""
        delays, waited = iter(RETRY_DELAYS_S), 0.0
        while True:
            try:
                return call()
            except NocturneClientError as error:
                waited += self.wait_for(error, next(delays, math.inf), self.patience_s - waited)

    def wait_for(self, error: NocturneClientError, delay_s: float, patience_s: float) -> float:
        """Waits before the next try, as long as the service said, else a delay; gives the seconds. Raises
        errors that last, or that would take more patience."""
        wait_s = error.retry_after_s or delay_s
        if not error.can_be_retried or wait_s > patience_s:
            raise error
        if error.retry_after_s and self._on_wait:
            self._on_wait(error, wait_s)
        time.sleep(wait_s)
        return wait_s


def _trusted(url: str) -> ssl.SSLContext | bool:
    """Whose certificates are believed: those in the PEM file NOCTURNE_CA, else what httpx believes.

    Nobody's where there are none to look at: to read all authorities takes as long as a hundred requests.
    """
    path = os.environ.get("NOCTURNE_CA")
    if not path:
        return not url.lower().startswith("http:")
    try:
        return ssl.create_default_context(cafile=path)
    except (OSError, ssl.SSLError) as error:
        raise NocturneClientError(f"NOCTURNE_CA: {path}: {error}") from error


def _raise_for(response: httpx.Response) -> None:
    """Raises what a problem document says; any other error answer as its status."""
    if response.status_code < 400:
        return
    response.read()
    # Never a date: the service says seconds.
    after = response.headers.get("retry-after", "")
    retry_after_s = float(after) if after.isascii() and after.isdecimal() else 0.0
    if response.status_code == httpx.codes.UNAUTHORIZED:
        raise NocturneClientError(_about_tokens(response), response.status_code)
    try:
        body = response.json()
        problems = [Problem(each["place"], each["message"]) for each in body.get("problems", [])]
        raise NocturneClientError(body["detail"], response.status_code, problems, retry_after_s)
    except (ValueError, KeyError, TypeError, AttributeError):
        message = f"{response.request.url} answered {response.status_code} {response.reason_phrase}"
        raise NocturneClientError(message, response.status_code, (), retry_after_s) from None


def _about_tokens(response: httpx.Response) -> str:
    """In words of those who set tokens, not of HTTP."""
    if "authorization" in response.request.headers:
        return "the service does not know this token, or it was revoked; see NOCTURNE_TOKEN"
    return (
        "the service wants a token: set NOCTURNE_TOKEN to one that `nocturne token create NAME` gave, on the "
        "machine of the service"
    )
