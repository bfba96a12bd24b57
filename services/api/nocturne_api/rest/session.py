"""The page's token: a browser's event streams and images carry no header of ours, but they carry a cookie.

See docs/decisions/0019-the-pages-token-is-a-cookie.md.
"""

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from nocturne_api.access import CALLER, secret_in
from nocturne_api.models.session import Session
from nocturne_api.rest.middleware import TOKEN_COOKIE, TOKEN_PATH
from nocturne_api.rest.requests import Service

router = APIRouter(prefix="/v1", tags=["session"])


@router.get("/session")
async def get_session() -> Session:
    """The caller and its rights; without authentication nobody, with all rights."""
    return _caller()


@router.post("/session", response_model=Session)
async def begin_session(request: Request, service: Service) -> Response:
    """Begins a session of the token in the Authorization header, by a cookie that scripts cannot read."""
    response = JSONResponse(_caller().model_dump())
    authorization = request.headers.get("authorization", "")
    if authorization:
        response.set_cookie(
            TOKEN_COOKIE,
            await service.begin_session(secret_in(authorization)),
            path=TOKEN_PATH,
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
        )
    return response


@router.delete("/session", status_code=204, response_class=Response)
async def end_session(request: Request, service: Service) -> Response:
    """Ends the session, wherever its cookie was copied to, and takes the cookie back."""
    if name := request.cookies.get(TOKEN_COOKIE):
        await service.end_session(name)
    response = Response(status_code=204)
    response.delete_cookie(TOKEN_COOKIE, path=TOKEN_PATH, httponly=True, samesite="strict")
    return response


def _caller() -> Session:
    caller = CALLER.get()
    return Session(name=caller.name, scopes=sorted(caller.scopes))
