"""Every error of the REST endpoint as RFC 9457 problem details, those of the framework included."""

from collections.abc import Mapping
from http import HTTPStatus

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from nocturne_scene.errors import InputError
from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse, Response

from nocturne_api.errors import TABLE, Failure, failure_of
from nocturne_api.models import problems as models
from nocturne_api.models.base import problems_of
from nocturne_api.models.problems import ProblemDetails
from nocturne_api.rest.contract import PROBLEM_MEDIA_TYPE


class ProblemResponse(JSONResponse):
    """A problem document."""

    media_type = PROBLEM_MEDIA_TYPE


def response_of(failure: Failure, headers: Mapping[str, str] | None = None) -> ProblemResponse:
    """The answer that tells a failure."""
    details = ProblemDetails(
        title=failure.kind.title,
        status=failure.kind.http_status,
        detail=failure.detail,
        reason=failure.kind.reason,
        problems=[models.Problem(place=each.place, message=each.message) for each in failure.problems],
    )
    if failure.kind.retry_after_s:
        headers = {**(headers or {}), "Retry-After": str(failure.kind.retry_after_s)}
    return ProblemResponse(details.model_dump(), failure.kind.http_status, headers)


def install(app: FastAPI) -> None:
    """Registers the answers to all errors."""
    for error_class, _ in TABLE:
        app.add_exception_handler(error_class, _answer)
    app.add_exception_handler(Exception, _answer)
    app.add_exception_handler(HTTPException, _answer_http)
    app.add_exception_handler(RequestValidationError, _answer_validation)


async def _answer(_: Request, error: Exception) -> Response:
    return response_of(failure_of(error))


async def _answer_http(_: Request, error: Exception) -> Response:
    """Errors of the framework's own: no such path, wrong method."""
    assert isinstance(error, HTTPException)  # noqa: S101 - what it was registered for
    status = HTTPStatus(error.status_code)
    details = ProblemDetails(title=status.phrase, status=status, detail=str(error.detail), reason=status.name)
    return ProblemResponse(details.model_dump(), status, error.headers)


async def _answer_validation(_: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)  # noqa: S101 - what it was registered for
    return response_of(failure_of(InputError(problems_of(error.errors()))))
