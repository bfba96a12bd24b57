"""What routes say of themselves beyond their signatures, and the OpenAPI document, made of it and the models.

docs/reference/openapi.json is that document as committed; the page's types and the Python client's models
are made from the file, so neither needs this package.
"""

from collections.abc import Mapping
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from nocturne_coordinator.errors import ObjectStoreUnavailable
from nocturne_scene.errors import InputError
from pydantic import BaseModel
from pydantic.json_schema import JsonSchemaMode, models_json_schema

from nocturne_api.errors import (
    INTERNAL,
    TABLE,
    Forbidden,
    Kind,
    RateLimited,
    Refused,
    RequestTimedOut,
    Unauthenticated,
)
from nocturne_api.models.base import MODEL_KEY, RequestBody
from nocturne_api.models.problems import ProblemDetails
from nocturne_api.models.render_requests import StopRequest
from nocturne_api.models.renders import TilesEvent
from nocturne_api.models.scenes import SceneDocument

PROBLEM_MEDIA_TYPE = "application/problem+json"

Responses = dict[int | str, dict[str, Any]]

DESCRIBED: list[type[BaseModel]] = [ProblemDetails, SceneDocument, StopRequest, TilesEvent]
"""Models that FastAPI does not see, because their bodies are read within bounds, or written in pieces."""

PROBLEMS: dict[str, dict[str, Any]] = {}
"""The error answers of all routes, by the reasons that they can have."""

# Any call can end so: a value that is not valid, no right to make it, too many, too slow, or storage that is
# away.
_ALWAYS = (
    InputError,
    Unauthenticated,
    Forbidden,
    Refused,
    RateLimited,
    RequestTimedOut,
    ObjectStoreUnavailable,
)


def reference_to(model: type[BaseModel]) -> dict[str, str]:
    """A reference to the model's schema, which the description then has."""
    if model not in DESCRIBED:
        DESCRIBED.append(model)
    return {"$ref": f"#/components/schemas/{model.__name__}"}


def body_of(model: type[BaseModel], required: bool = True) -> dict[str, Any]:
    """The description of a body that `read_json` reads."""
    content = {"application/json": {"schema": reference_to(model)}}
    return {"requestBody": {"required": required, "content": content}}


def answers(media_type: str, about: str, conditional: bool = False) -> Responses:
    """A binary answer; `conditional`: 304 where If-None-Match has its ETag."""
    schema = {"type": "string", "format": "binary"}
    etag = {"ETag": {"description": "Changes when the content does.", "schema": {"type": "string"}}}
    found: Responses = {200: {"description": about, "content": {media_type: {"schema": schema}}}}
    if conditional:
        found[200]["headers"] = etag
        found[304] = {"description": "Not changed since If-None-Match.", "headers": etag}
    return found


def errors(*classes: type[Exception]) -> Responses:
    """Problem details for these errors, and for those that any call can end with."""
    kinds = [kind for error_class, kind in TABLE if error_class in (*_ALWAYS, *classes)] + [INTERNAL]
    by_status: dict[int, list[Kind]] = {}
    for kind in kinds:
        by_status.setdefault(kind.http_status, []).append(kind)
    return {status: _problem(of_status) for status, of_status in sorted(by_status.items())}


def _problem(kinds: list[Kind]) -> dict[str, Any]:
    name = "-".join(kind.reason for kind in kinds)
    examples = {kind.reason: {"value": _example(kind)} for kind in kinds}
    content = {"schema": reference_to(ProblemDetails), "examples": examples}
    about = "; ".join(f"{kind.reason}: {kind.title}" for kind in kinds)
    PROBLEMS[name] = {"description": f"{about}.", "content": {PROBLEM_MEDIA_TYPE: content}}
    return {"$ref": f"#/components/responses/{name}", "description": f"{about}."}


def _example(kind: Kind) -> Mapping[str, Any]:
    details = ProblemDetails(
        title=kind.title, status=kind.http_status, detail=f"{kind.title}.", reason=kind.reason
    )
    return details.model_dump()


_ABOUT = (
    "Renders scenes into spectral images in absolute units, with error bars.\n\n"
    "Errors are problem details (RFC 9457) with a `reason` for programs and the places of all problems. "
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
    "webhooks": "Addresses that get a message when renders end (standardwebhooks.com).",
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
