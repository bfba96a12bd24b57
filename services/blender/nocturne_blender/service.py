"""A Nocturne service, by its REST API. Knows nothing of Blender, and needs the standard library alone."""

import json
import os
import ssl
import time
import urllib.error
import urllib.request
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

Json = Any

_TIMEOUT_S = 60.0
# Between attempts while the service is not reached, or busy without saying for how long.
_DELAYS_S = (0.2, 0.5, 1.0)
# Of a render that is at work: its service may be started again.
_FOLLOW_DELAYS_S = (*_DELAYS_S, *([2.0] * 150))
# Between looks at whether a render that waits was cancelled.
_PIECE_S = 0.25
_BUSY = (429, 503)
_ENDED = ("SUCCEEDED", "STOPPED_EARLY", "DEGRADED", "FAILED", "CANCELLED")


class ServiceError(Exception):
    """What went wrong, in words for whoever pressed the button."""


class NotReached(ServiceError):
    """No service at this address."""


@dataclass(frozen=True)
class Job:
    """A scene to be rendered."""

    name: str
    scene: Json
    width: int
    height: int
    samples: int
    stop: Mapping[str, Json]


class Service:
    """One service. Every method raises ServiceError."""

    def __init__(
        self, url: str, token: str = "", on_wait: Callable[[str, float], None] | None = None
    ) -> None:
        """A service that is busy, or has a quota used up, says after how long to ask again: calls wait for
        that, as often as it does. `on_wait` gets why and the seconds left, several times a second; what it
        raises ends the call."""
        if not url.startswith(("http://", "https://")):
            raise ServiceError(f"{url!r} is not an address; expected one such as http://127.0.0.1:7070")
        self._url = url.rstrip("/")
        self._on_wait = on_wait
        self._headers = {"Authorization": f"Bearer {token}"} if token else {}
        context = ssl.create_default_context(cafile=os.environ.get("NOCTURNE_CA"))
        # No proxies: scenes go to the address that was given.
        self._opener = urllib.request.build_opener(
            urllib.request.ProxyHandler({}), urllib.request.HTTPSHandler(context=context)
        )

    def is_up(self) -> bool:
        """Whether it answers."""
        try:
            self._once("GET", "/healthz")
        except ServiceError:
            return False
        return True

    def upload(self, files: Mapping[str, bytes]) -> Iterator[float]:
        """Sends the files that the service lacks; yields the part that is done after each."""
        digests = list(files)
        # The service takes at most 1000 names at once.
        lots = [digests[start : start + 1000] for start in range(0, len(digests), 1000)]
        missing = [
            name for lot in lots for name in self._post("/v1/assets:batchMissing", {"sha256": lot})["sha256"]
        ]
        total = sum(len(files[name]) for name in missing)
        sent = 0
        for name in missing:
            self._send("PUT", f"/v1/assets/{name}", files[name], "application/octet-stream")
            sent += len(files[name])
            # All of them may be empty.
            yield sent / total if total else 1.0

    def create(self, job: Job) -> Json:
        """Submits a scene; gives the render."""
        request = {
            "request_id": str(uuid.uuid4()),
            "name": job.name,
            "scene": job.scene,
            "width": job.width,
            "height": job.height,
            "samples": job.samples,
            "stop": dict(job.stop),
        }
        return self._post("/v1/renders", request)

    def render(self, identity: str) -> Json:
        """The render as it is now."""
        return json.loads(self._send("GET", f"/v1/renders/{identity}", delays_s=_FOLLOW_DELAYS_S))

    def tiles(self, identity: str, since: str) -> bytes:
        """Tiles that changed; empty where none did."""
        query = f"?since={since}" if since else ""
        return self._send("GET", f"/v1/renders/{identity}/tiles{query}", delays_s=_FOLLOW_DELAYS_S)

    def cancel(self, identity: str) -> None:
        """Stops a render, whatever `on_wait` says; what it has stays at the service."""
        self._send("POST", f"/v1/renders/{identity}:cancel", b"{}", "application/json", quiet=True)

    def _post(self, path: str, body: Json) -> Json:
        return json.loads(self._send("POST", path, json.dumps(body).encode(), "application/json"))

    def _send(
        self,
        method: str,
        path: str,
        body: bytes | None = None,
        kind: str = "",
        delays_s: Iterable[float] = _DELAYS_S,
        quiet: bool = False,
    ) -> bytes:
        delays = iter(delays_s)
        while True:
            try:
                return self._once(method, path, body, kind)
            except _Again as error:
                delay = error.after_s or next(delays, 0.0)
                if not delay:
                    raise
                self._wait(str(error), delay, quiet)

    def _wait(self, why: str, seconds: float, quiet: bool) -> None:
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            if self._on_wait and not quiet:
                self._on_wait(why, left)
            time.sleep(min(left, _PIECE_S))

    def _once(self, method: str, path: str, body: bytes | None = None, kind: str = "") -> bytes:
        headers = self._headers | ({"Content-Type": kind} if kind else {})
        request = urllib.request.Request(self._url + path, body, headers, method=method)  # noqa: S310 - http(s) only
        try:
            with self._opener.open(request, timeout=_TIMEOUT_S) as answer:
                content: bytes = answer.read()
                return content
        except urllib.error.HTTPError as error:
            if error.code == 304:
                return b""
            said = _said(error)
            if error.code not in _BUSY:
                raise ServiceError(said) from error
            after = error.headers.get("Retry-After", "")
            raise _Again(said, float(after) if after.isascii() and after.isdecimal() else 0.0) from error
        except (OSError, urllib.error.URLError) as error:
            reason = getattr(error, "reason", error)
            raise _Again(
                f"no answer from {self._url} ({reason}); start a service with "
                "`nocturne up`, or give its address"
            ) from error


class _Again(NotReached):
    """What may be better in a moment, or `after_s` seconds where the service said so."""

    def __init__(self, message: str, after_s: float = 0.0) -> None:
        super().__init__(message)
        self.after_s = after_s


def _said(error: urllib.error.HTTPError) -> str:
    """What a problem document says, with the first places in the scene."""
    try:
        body = json.loads(error.read())
        places = [f"{each['place']}: {each['message']}" for each in body.get("problems", [])[:3]]
        return "; ".join([body["detail"], *(place for place in places if place not in body["detail"])])
    except (ValueError, KeyError, TypeError, AttributeError):
        return f"the service answered {error.code} {error.reason}"


def has_ended(render: Json) -> bool:
    """Whether there will be no more samples."""
    return render["state"] in _ENDED


def wait_until_up(service: Service, is_alive: Callable[[], bool], seconds: float) -> None:
    """Waits for a service that was just started; raises ServiceError."""
    end = time.monotonic() + seconds
    while not service.is_up():
        if not is_alive():
            raise ServiceError("the local service did not start; its log is in the data folder")
        if time.monotonic() > end:
            raise ServiceError(f"the local service did not answer within {seconds:.0f} s")
        time.sleep(0.2)
