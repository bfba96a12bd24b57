"""Security middleware: who may ask, and which headers every answer carries."""

from collections.abc import Callable
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import cookie_parser
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from nocturne_api.access import CALLER, Authenticator, Caller, secret_in
from nocturne_api.errors import Refused, Unauthenticated, failure_of
from nocturne_api.rest.problems import response_of

TOKEN_COOKIE = "nocturne_token"  # noqa: S105 - a name
TOKEN_PATH = "/v1"  # noqa: S105 - a path
"""Of the cookie: the page's files and the rest of the server's addresses do not get it."""

_LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})
_READING = frozenset({"GET", "HEAD", "OPTIONS"})

# The page loads nothing from elsewhere; images also come from canvas exports and blobs.
CONTENT_SECURITY_POLICY = "; ".join(
    (
        "default-src 'self'",
        "img-src 'self' data: blob:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    )
)
_HEADERS = {
    "Content-Security-Policy": CONTENT_SECURITY_POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


class SecurityMiddleware:
    """Refuses what a foreign web page made its visitor's browser send; adds security headers to all answers.

    `loopback_only`: the service is bound to this machine, so any Host but a loopback name is DNS rebinding.
    """

    def __init__(
        self,
        app: ASGIApp,
        loopback_only: bool,
        authenticator: Authenticator | None = None,
        check_folder: Callable[[], None] = lambda: None,
    ) -> None:
        """Without an authenticator anybody may do anything. `check_folder` raises where the data folder is
        gone."""
        self._app = app
        self._check_folder = check_folder
        self._loopback_only = loopback_only
        self._authenticator = authenticator

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(raw=message["headers"])
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        refusal = self._refusal(scope["method"], Headers(scope=scope))
        app = response_of(failure_of(Refused(refusal))) if refusal else self._app
        if app is self._app and _needs_token(scope["path"]):
            address = scope["client"][0] if scope.get("client") else ""
            try:
                self._check_folder()
                if self._authenticator is not None:
                    CALLER.set(await _caller(self._authenticator, Headers(scope=scope), address))
            except Exception as error:
                headers = _challenge(Headers(scope=scope)) if isinstance(error, Unauthenticated) else None
                app = response_of(failure_of(error), headers)
        await app(scope, receive, send_with_headers)

    def _refusal(self, method: str, headers: Headers) -> str:
        host = headers.get("host", "")
        if self._loopback_only and _name(host) not in _LOOPBACK_NAMES:
            return f"This service answers to localhost only, not to {_name(host)[:80]!r}."
        origin = headers.get("origin")
        from_elsewhere = origin is not None and urlsplit(origin).netloc != host
        # Browsers say so even where they send no origin.
        from_elsewhere |= headers.get("sec-fetch-site", "none") not in ("same-origin", "none")
        if method not in _READING and from_elsewhere:
            return "Requests that change something are taken from this service's own page only."
        return ""


async def _caller(authenticator: Authenticator, headers: Headers, address: str) -> Caller:
    """By the token in a request's header, or the session in the page's cookie."""
    cookies = cookie_parser(headers.get("cookie", ""))
    authorization = headers.get("authorization", "")
    if TOKEN_COOKIE in cookies and not authorization:
        return await authenticator.of_session(cookies[TOKEN_COOKIE])
    return await authenticator.authenticate(secret_in(authorization), address)


def _challenge(headers: Headers) -> dict[str, str]:
    """Browsers ask for a Basic password by themselves where they open an address; the page has its own
    form."""
    is_script = headers.get("sec-fetch-dest", "document") != "document"
    challenge = {"WWW-Authenticate": "Bearer" if is_script else 'Basic realm="nocturne", Bearer'}
    if TOKEN_COOKIE in headers.get("cookie", ""):
        challenge["Set-Cookie"] = f"{TOKEN_COOKIE}=; Path={TOKEN_PATH}; Max-Age=0; HttpOnly; SameSite=Strict"
    return challenge


def _needs_token(path: str) -> bool:
    """All but the page's own files and the probes of orchestrators."""
    return path.startswith("/v1") or path in ("/metrics", "/openapi.json", "/scene.schema.json", "/docs")


def _name(host: str) -> str:
    """The name in a Host header, without its port."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""
