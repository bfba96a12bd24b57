"""Every error that a caller can meet, and what each transport calls it: one table for REST and gRPC."""

import logging
from dataclasses import dataclass

import grpc
from nocturne_coordinator.errors import (
    AmbiguousId,
    Conflict,
    ObjectStoreUnavailable,
    QuotaUsedUp,
    StoreUnavailable,
    WrongState,
)
from nocturne_coordinator.store.database import DatabaseUnavailable
from nocturne_scene.errors import InputError, NocturneError, NotFound, Problem

from nocturne_api.limits import PROBLEM_CHARACTERS, PROBLEMS_PER_ANSWER

_log = logging.getLogger(__name__)


class Overloaded(NocturneError):
    """Too much is being asked at once; the same request can succeed later."""


class FolderSlow(Overloaded):
    """The data folder takes too long, and others wait for it too."""


class Refused(NocturneError):
    """The request may not be made from where it comes."""


class Unauthenticated(NocturneError):
    """The call has no token, or one that is not known."""


class Forbidden(NocturneError):
    """The caller is known, and may not do this."""


class RateLimited(NocturneError):
    """The caller calls too often."""


class ClientDisconnected(NocturneError):
    """The caller went away before the end of the request."""


class FolderFull(NocturneError):
    """The data folder has reached its bound."""


class RequestTimedOut(NocturneError):
    """The request did not come to its end in time."""


class PreflightFailed(NocturneError):
    """The service can't preflight this scene, or no scene at all; says why."""


@dataclass(frozen=True)
class Kind:
    """What one class of error is called in words, in REST and in gRPC."""

    reason: str
    title: str
    http_status: int
    grpc_status: grpc.StatusCode
    retry_after_s: int = 0
    """When the same may succeed, roughly: Retry-After in REST, the trailer `retry-after` in gRPC. 0: not
    told."""


@dataclass(frozen=True)
class Failure:
    """One error, ready to be reported by either transport."""

    kind: Kind
    detail: str
    problems: tuple[Problem, ...] = ()


INTERNAL = Kind("INTERNAL", "Internal error", 500, grpc.StatusCode.INTERNAL)

# First match wins, so a subclass stands before its base.
TABLE: tuple[tuple[type[Exception], Kind], ...] = (
    (InputError, Kind("INVALID_INPUT", "The request is not valid", 422, grpc.StatusCode.INVALID_ARGUMENT)),
    (NotFound, Kind("NOT_FOUND", "Not found", 404, grpc.StatusCode.NOT_FOUND)),
    (Conflict, Kind("CONFLICT", "In conflict with an earlier request", 409, grpc.StatusCode.ALREADY_EXISTS)),
    (
        WrongState,
        Kind("WRONG_STATE", "Not in this state", 409, grpc.StatusCode.FAILED_PRECONDITION),
    ),
    (
        PreflightFailed,
        Kind("CANT_PREFLIGHT", "No preflight can be made", 409, grpc.StatusCode.FAILED_PRECONDITION),
    ),
    (
        AmbiguousId,
        Kind(
            "AMBIGUOUS_ID",
            "Several ids begin so",
            409,
            grpc.StatusCode.FAILED_PRECONDITION,
        ),
    ),
    (Refused, Kind("REFUSED", "Refused", 403, grpc.StatusCode.PERMISSION_DENIED)),
    (
        Unauthenticated,
        Kind(
            "UNAUTHENTICATED",
            "A known token is needed",
            401,
            grpc.StatusCode.UNAUTHENTICATED,
        ),
    ),
    (Forbidden, Kind("FORBIDDEN", "Not allowed", 403, grpc.StatusCode.PERMISSION_DENIED)),
    (RateLimited, Kind("TOO_MANY", "Too many calls", 429, grpc.StatusCode.RESOURCE_EXHAUSTED, 1)),
    (QuotaUsedUp, Kind("QUOTA", "Quota used up", 429, grpc.StatusCode.RESOURCE_EXHAUSTED, 60)),
    (
        FolderFull,
        Kind("FOLDER_FULL", "The data folder is full", 507, grpc.StatusCode.RESOURCE_EXHAUSTED, 60),
    ),
    (ClientDisconnected, Kind("BROKEN_OFF", "The request was broken off", 400, grpc.StatusCode.CANCELLED)),
    (
        RequestTimedOut,
        Kind("TOO_SLOW", "The request came too slowly", 408, grpc.StatusCode.DEADLINE_EXCEEDED),
    ),
    (Overloaded, Kind("OVERLOADED", "Too much at once", 503, grpc.StatusCode.UNAVAILABLE, 5)),
    (
        ObjectStoreUnavailable,
        Kind("STORE", "The storage does not answer", 503, grpc.StatusCode.UNAVAILABLE, 5),
    ),
    (
        StoreUnavailable,
        Kind("STORE", "The storage does not answer", 503, grpc.StatusCode.UNAVAILABLE, 5),
    ),
    (
        DatabaseUnavailable,
        Kind("STORE", "The storage does not answer", 503, grpc.StatusCode.UNAVAILABLE, 5),
    ),
)


def failure_of(error: Exception) -> Failure:
    """What to tell the caller. Errors outside the table are logged and told without their details."""
    for error_class, kind in TABLE:
        if isinstance(error, error_class):
            problems = _bounded(error.problems) if isinstance(error, InputError) else ()
            return Failure(kind, _cut(str(error)) or kind.title, problems)
    _log.error("unexpected error", exc_info=error)
    return Failure(INTERNAL, "Something went wrong inside the service; its log has the details.")


def _bounded(problems: tuple[Problem, ...]) -> tuple[Problem, ...]:
    return tuple(Problem(_cut(each.place), _cut(each.message)) for each in problems[:PROBLEMS_PER_ANSWER])


def _cut(text: str) -> str:
    return text if len(text) <= PROBLEM_CHARACTERS else text[: PROBLEM_CHARACTERS - 3] + "..."
