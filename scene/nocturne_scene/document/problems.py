"""Turns pydantic's errors into problems at places that a person can find in the document."""

import json
import math
import re
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated, Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from nocturne_scene.document import bounds
from nocturne_scene.document.node import NAMED, quoted_list, tag_of
from nocturne_scene.errors import Problem

_PLAIN_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_TAG = re.compile(r"<[A-Za-z]+>")
_VALUE_SHOWN = 60  # characters of an offending value


def path(steps: Iterable[str | int]) -> str:
    """Render steps into a JSON document as a path: `$.surfaces[3].kernel`; unusual keys are quoted."""
    return "$" + "".join(_step(step) for step in steps)


def _step(step: str | int) -> str:
    if isinstance(step, int):
        return f"[{step}]"
    if _PLAIN_KEY.fullmatch(step):
        return f".{step}"
    return f"[{json.dumps(step[: bounds.NAME_LENGTH])}]"


def problems_of(error: ValidationError, model: type[BaseModel]) -> list[Problem]:
    """Return at most `bounds.PROBLEMS` problems, in the order of the schema."""
    details = error.errors(include_url=False)[: bounds.PROBLEMS]
    return [_problem(detail, model) for detail in details]


def _problem(detail: ErrorDetails, model: type[BaseModel]) -> Problem:
    steps = [step for index, step in enumerate(detail["loc"]) if not _is_noise(detail["loc"], index)]
    suffix = detail.get("ctx", {}).get("suffix", "")
    return Problem(path(steps) + suffix, _message(detail, model))


def _is_noise(location: Sequence[str | int], index: int) -> bool:
    """Pydantic's location also names the arm of a union and, for a bad key of a dictionary, "[key]"."""
    step = location[index]
    if isinstance(step, int):
        return False
    named_by_user = index == 1 and location[0] in NAMED
    return not named_by_user and (step == "[key]" or _TAG.fullmatch(step) is not None)


def _message(detail: ErrorDetails, model: type[BaseModel]) -> str:
    words = _WORDS.get(detail["type"])
    if detail["type"] == "extra_forbidden":
        fields = _fields_around(detail["loc"], model)
        return f"unknown field; expected one of {quoted_list(fields)}"
    if words is None:
        return detail["msg"]
    return words(detail.get("ctx", {}), _shown(detail["input"]))


_Words = Callable[[dict[str, Any], str], str]
_WORDS: dict[str, _Words] = {
    "scene": lambda context, _: str(context["message"]),
    "missing": lambda *_: "missing",
    "literal_error": lambda context, value: f"expected {_literals(context['expected'])}, found {value}",
    "finite_number": lambda _, value: f"expected a finite number, found {value}",
    "float_type": lambda _, value: f"expected a number, found {value}",
    "int_type": lambda _, value: f"expected a whole number, found {value}",
    "int_from_float": lambda _, value: f"expected a whole number, found {value}",
    "string_type": lambda _, value: f"expected text, found {value}",
    "string_unicode": lambda *_: "expected text that is valid Unicode",
    "string_pattern_mismatch": lambda context, value: (
        f"expected text of the form {context['pattern']}, found {value}"
    ),
    "bool_type": lambda _, value: f"expected true or false, found {value}",
    "list_type": lambda _, value: f"expected a list, found {value}",
    "tuple_type": lambda _, value: f"expected a list, found {value}",
    "dict_type": lambda _, value: f"expected an object, found {value}",
    "model_type": lambda _, value: f"expected an object, found {value}",
    "model_attributes_type": lambda _, value: f"expected an object, found {value}",
    "greater_than": lambda context, value: f"must be more than {context['gt']:g}, found {value}",
    "greater_than_equal": lambda context, value: f"must be at least {context['ge']:g}, found {value}",
    "less_than": lambda context, value: f"must be less than {context['lt']:g}, found {value}",
    "less_than_equal": lambda context, value: f"must be at most {context['le']:g}, found {value}",
    "too_short": lambda context, _: (
        f"expected at least {context['min_length']} entries, found {context['actual_length']}"
    ),
    "too_long": lambda context, _: (
        f"expected at most {context['max_length']} entries, found {_many(context)}"
    ),
    "string_too_long": lambda context, _: f"expected at most {context['max_length']} characters",
    "string_too_short": lambda context, _: f"expected at least {context['min_length']} characters",
}


def _many(context: dict[str, Any]) -> str:
    """Pydantic does not count on once a list is too long."""
    return str(context["actual_length"] or "more")


def _literals(expected: str) -> str:
    """Pydantic writes `'a', 'b' or 'c'`; JSON has double quotes."""
    return ("one of " if " or " in expected else "") + expected.replace("'", '"').replace(" or ", ", ")


def _shown(value: Any) -> str:
    """Render a value of a JSON document on one short line."""
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list):
        return "a list"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, int) and not isinstance(value, bool) and value.bit_length() > 200:
        return "a very large number"
    text = json.dumps(value[:_VALUE_SHOWN] if isinstance(value, str) else value, default=str)
    return text if len(text) <= 2 * _VALUE_SHOWN else text[:_VALUE_SHOWN] + "..."


def _fields_around(location: Sequence[str | int], model: type[BaseModel]) -> list[str]:
    """Return the names of the fields of the object that the last step of `location` is in."""
    around: Any = model
    for step in location[:-1]:
        around = _inside(around, step)
    kind = _first_arm(around)
    fields = kind.model_fields if _is_model(kind) else ()
    return sorted(fields, key=lambda name: name != "type")  # the rest as it is


def _inside(kind: Any, step: str | int) -> Any:
    """Follow one step of a pydantic location through a type: an arm's tag, a field, a key or an index."""
    tagged = [arm for arm in _arms(kind) if tag_of(arm) == step]
    if tagged:
        return tagged[0]
    bare = _first_arm(kind)
    if _is_model(bare):
        return bare.model_fields[str(step)].annotation
    return get_args(bare)[-1]


def _is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def _first_arm(kind: Any) -> Any:
    """The type itself, without constraints and without "or None"."""
    return _bare(_arms(kind)[0])


def _bare(kind: Any) -> Any:
    return get_args(kind)[0] if get_origin(kind) is Annotated else kind


def _arms(kind: Any) -> tuple[Any, ...]:
    """The types of a union, those of unions inside it included."""
    bare = _bare(kind)
    if not _is_union(bare):
        return (kind,)
    return tuple(inner for arm in get_args(bare) for inner in _arms(arm))


def _is_union(kind: Any) -> bool:
    return str(get_origin(kind)) in ("typing.Union", "<class 'types.UnionType'>")
