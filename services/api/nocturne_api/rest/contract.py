"""What routes say of themselves beyond their signatures: bodies, errors and binary answers, for OpenAPI."""

from collections.abc import Mapping
from typing import Any

from nocturne_coordinator.errors import ObjectStoreUnavailable
from nocturne_scene.errors import InputError
from pydantic import BaseModel

from nocturne_api.errors import INTERNAL, TABLE, Forbidden, Kind, Refused, TooMany, TooSlow, Unauthenticated
from nocturne_api.models.events import TilesEvent
from nocturne_api.models.problems import ProblemDetails
from nocturne_api.models.renders import SceneDocument, StopRequest

PROBLEM_MEDIA_TYPE = "application/problem+json"

Responses = dict[int | str, dict[str, Any]]

DESCRIBED: list[type[BaseModel]] = [ProblemDetails, SceneDocument, StopRequest, TilesEvent]
"""Models that FastAPI does not see, because their bodies are read within bounds, or written in pieces."""

PROBLEMS: dict[str, dict[str, Any]] = {}
"""The error answers of all routes, by the reasons that they can have."""

# Any call can end so: a value that is not valid, no right to make it, too many, too slow, or storage that is
# away.
_ALWAYS = (InputError, Unauthenticated, Forbidden, Refused, TooMany, TooSlow, ObjectStoreUnavailable)


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
