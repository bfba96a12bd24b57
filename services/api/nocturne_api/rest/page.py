"""The page, and the API reference at /docs: Swagger UI, built with the page and served from here."""

from pathlib import Path
from typing import Any

from fastapi import APIRouter, Request
from nocturne_scene.document.reference import json_schema
from starlette.exceptions import HTTPException
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.types import Receive, Scope, Send

_PACKAGED = Path(__file__).resolve().parents[1] / "page"
# services/api/nocturne_api/rest/page.py -> services/web/dist
_IN_CHECKOUT = Path(__file__).resolve().parents[3] / "web" / "dist"
_NOT_BUILT = (
    "The page is not built; run `make web`, or start with --web FOLDER. The API works: see /openapi.json.\n"
)
# Vite puts a hash of the content into the names of files below assets/.
_FOREVER = "public, max-age=31536000, immutable"
_ASK_FIRST = "no-cache"


def built_page() -> Path:
    """The folder of the page: in the installed package, else in the checkout, where it may not be built."""
    return _PACKAGED if _PACKAGED.is_dir() else _IN_CHECKOUT


class Page:
    """An ASGI application for all but the API: files of `folder`, its index.html for the page's addresses."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder.resolve()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        path = str(scope["path"]).strip("/")
        if scope["method"] not in ("GET", "HEAD") or path.split("/")[0] == "v1":
            raise HTTPException(404)
        await self._answer(path)(scope, receive, send)

    def file(self, path: str) -> Response:
        """A file of the page at another address than its own; one sentence where the page is not built."""
        file = self._file(path)
        return PlainTextResponse(_NOT_BUILT) if file is None else _fresh(file)

    def _answer(self, path: str) -> Response:
        index = self._folder / "index.html"
        if not path and not index.is_file():
            return PlainTextResponse(_NOT_BUILT)
        file = self._file(path)
        if file is not None:
            cache = _FOREVER if path.startswith("assets/") else _ASK_FIRST
            return FileResponse(file, headers={"Cache-Control": cache})
        if "." in path.rpartition("/")[2] or not index.is_file():
            raise HTTPException(404)
        return _fresh(index)

    def _file(self, path: str) -> Path | None:
        """The file of the folder at `path`; None for a file that is missing or outside of the folder."""
        if "\0" in path:
            return None
        file = (self._folder / path).resolve()
        return file if file.is_relative_to(self._folder) and file.is_file() else None


def _fresh(file: Path) -> FileResponse:
    """A file that browsers keep, but ask for before every use."""
    return FileResponse(file, headers={"Cache-Control": _ASK_FIRST})


router = APIRouter(include_in_schema=False)


@router.get("/docs")
async def reference(request: Request) -> Response:
    """The reference viewer; it loads nothing from elsewhere."""
    response: Response = request.app.state.page.file("reference.html")
    return response


@router.get("/scene.schema.json")
async def scene_schema() -> dict[str, Any]:
    """The JSON Schema of scene documents."""
    return json_schema()
