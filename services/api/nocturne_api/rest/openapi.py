"""The OpenAPI document, made from the routes and the models.

docs/reference/openapi.json is that document as committed; the page's types and the Python client's models
are made from the file, so neither needs this package.
"""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import JsonSchemaMode, models_json_schema

from nocturne_api.models.base import MODEL_KEY, RequestBody
from nocturne_api.rest.contract import DESCRIBED, PROBLEMS

_ABOUT = (
    "Renders scenes into spectral images in absolute units, with error bars.\n\n"
    "Errors are problem details (RFC 9457) with a `reason` for programs and the places of what is wrong. "
    "Times are Unix times in seconds. Calls with a `request_id` are safe to repeat."
)
_TAGS = {
    "renders": "Scenes being rendered, and their state.",
    "images": "Previews, images, and the tiles that changed.",
    "measurements": "Photometry of images: regions, lines, histograms, isolines and glare.",
    "events": "Changes as server-sent events.",
    "preflights": "What a scene needs for a target error, before it is rendered.",
    "imports": "Scenes of other renderers, made scene documents.",
    "assets": "Files by SHA-256; scenes refer to them as `sha256:...`.",
    "workers": "Who traces, and who gets no jobs.",
    "webhooks": "Addresses that are told how renders end (standardwebhooks.com).",
    "session": "Who calls, and the page's cookie.",
    "health": "For orchestrators and Prometheus.",
}


class DescribedApp(FastAPI):
    """An application that describes itself with `document`."""

    def openapi(self) -> dict[str, Any]:
        """The OpenAPI document, made once."""
        if self.openapi_schema is None:
            self.openapi_schema = document(self)
        return self.openapi_schema


def document(app: FastAPI) -> dict[str, Any]:
    """The OpenAPI document of the application's routes."""
    found = get_openapi(
        title="Nocturne",
        version="1",
        description=_ABOUT,
        routes=app.routes,
        tags=[{"name": name, "description": about} for name, about in _TAGS.items()],
    )
    models: list[tuple[type[BaseModel], JsonSchemaMode]] = [
        (model, "validation" if issubclass(model, RequestBody) else "serialization") for model in DESCRIBED
    ]
    _, schemas = models_json_schema(models, ref_template="#/components/schemas/{model}")
    components = found.setdefault("components", {})
    components["schemas"] = {**components.get("schemas", {}), **schemas["$defs"]}
    components["responses"] = dict(sorted(PROBLEMS.items()))
    components["securitySchemes"] = {"token": {"type": "http", "scheme": "bearer"}}
    for operation in (each for methods in found["paths"].values() for each in methods.values()):
        operation["summary"] = operation["description"].partition(".\n")[0].partition(". ")[0].rstrip(".")
        operation["responses"] = dict(sorted(operation["responses"].items()))
    found["security"] = [{"token": []}, {}]
    _tidy([found["paths"], components])
    components["schemas"] = dict(sorted(components["schemas"].items()))
    return found


def _tidy(part: Any) -> None:
    """Without the titles that repeat names, and with references where a model gives only its schema."""
    if isinstance(part, list):
        for each in part:
            _tidy(each)
    if not isinstance(part, dict):
        return
    if isinstance(part.get("title"), str):
        del part["title"]
    if name := part.pop(MODEL_KEY, None):
        part["$ref"] = f"#/components/schemas/{name}"
    for name, value in part.items():
        if name not in ("example", "examples", "default"):
            _tidy(value)
