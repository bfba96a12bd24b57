"""The service's JSON as the models of contract.py."""

from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, TypeVar, cast, get_args, get_origin, get_type_hints

from nocturne_client.errors import NocturneClientError

_Model = TypeVar("_Model")


def decode(model: type[_Model], value: Any) -> _Model:
    """A model from JSON; fields of later versions are left out. NocturneClientError where one is missing."""
    try:
        return cast(_Model, _decoded(model, value))
    except (KeyError, TypeError) as error:
        raise NocturneClientError(
            f"the service's answer is no {model.__name__} ({error}): client and service have different "
            "versions; use those of one release"
        ) from error


def _decoded(kind: Any, value: Any) -> Any:
    if is_dataclass(kind) and isinstance(kind, type):
        hints = _hints(kind)
        return kind(**{each.name: _decoded(hints[each.name], value[each.name]) for each in fields(kind)})
    if get_origin(kind) is list:
        return [_decoded(get_args(kind)[0], each) for each in value]
    models = [each for each in get_args(kind) if is_dataclass(each)]
    return _decoded(models[0], value) if models and value is not None else value


@cache
def _hints(model: type[Any]) -> dict[str, Any]:
    return get_type_hints(model)
