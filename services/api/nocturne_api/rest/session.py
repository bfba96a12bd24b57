"""The page's token: a browser's event streams and images carry no header of ours, but they carry a cookie.

See docs/decisions/0019-the-pages-token-is-a-cookie.md.
"""

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from nocturne_api.access import CALLER, secret_in
from nocturne_api.models.session import Session
from nocturne_api.rest.middleware import TOKEN_COOKIE, TOKEN_PATH

router = APIRouter(prefix="/v1", tags=["session"])


@router.get("/session")
async def get_session() -> Session:
    """Who the caller is, and what it may do; without authentication nobody, and everything."""
    return _caller()


@router.post("/session", response_model=Session)
async def begin_session(request: Request) -> Response:
    """Takes the token of the Authorization header into a cookie that scripts cannot read."""
    response = JSONResponse(_caller().model_dump())
    authorization = request.headers.get("authorization", "")
    if authorization:
        response.set_cookie(
            TOKEN_COOKIE,
            secret_in(authorization),
            path=TOKEN_PATH,
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
        )
    return response


@router.delete("/session", status_code=204, response_class=Response)
async def end_session() -> Response:
    """Takes the cookie back."""
    response = Response(status_code=204)
    response.delete_cookie(TOKEN_COOKIE, path=TOKEN_PATH, httponly=True, samesite="strict")
    return response


def _caller() -> Session:
    caller = CALLER.get()
    return Session(name=caller.name, scopes=sorted(caller.scopes))
