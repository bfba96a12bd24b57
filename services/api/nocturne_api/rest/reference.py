"""The REST door's operations at /docs: plain HTML made from the OpenAPI document, nothing from elsewhere."""

from html import escape

from fastapi import APIRouter, Request
from starlette.responses import HTMLResponse

router = APIRouter(include_in_schema=False)

_HEAD = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>Nocturne API</title>
<h1>Nocturne API</h1>
<p>The machine-readable description is <a href="/openapi.json">/openapi.json</a>. Errors are
<a href="https://www.rfc-editor.org/rfc/rfc9457">RFC 9457</a> problem details with a list of
<code>problems</code>, each a <code>place</code> and a <code>message</code>.</p>
<dl>
"""


@router.get("/docs", response_class=HTMLResponse)
async def reference(request: Request) -> str:
    """All operations with what they do."""
    paths = request.app.openapi()["paths"]
    entries = [
        f"<dt><code>{method.upper()} {escape(path)}</code></dt><dd>{escape(about['description'])}</dd>\n"
        for path, operations in paths.items()
        for method, about in operations.items()
    ]
    return _HEAD + "".join(entries) + "</dl></html>\n"
