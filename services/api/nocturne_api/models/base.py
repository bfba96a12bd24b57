"""What all models of the contract have in common."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from nocturne_scene.errors import InputError, Problem
from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, ValidationError
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema


class Answer(BaseModel):
    """Something that the service says. Immutable."""

    model_config = ConfigDict(
        frozen=True, from_attributes=True, json_schema_serialization_defaults_required=True
    )


class RequestBody(BaseModel):
    """Something that a caller sends. Unknown fields are errors, and no value is converted."""

    model_config = ConfigDict(extra="forbid", strict=True)


_Body = TypeVar("_Body", bound=RequestBody)


def validated(kind: type[_Body], value: object) -> _Body:
    """What a caller sent, decoded, as the body of this class; InputError with all problems of its form."""
    try:
        return kind.model_validate(value)
    except ValidationError as error:
        details = error.errors(include_url=False, include_input=False, include_context=False)
        raise InputError(problems_of([{**each, "loc": ("body", *each["loc"])} for each in details])) from None


def problems_of(errors: Sequence[Any]) -> list[Problem]:
    """Pydantic's errors as problems: ("body", "a", 0) is the place `$.a[0]`, ("query", "n") is `query.n`."""
    return [Problem(_place(error["loc"]), f"{error['msg']}") for error in errors]


def _place(location: Sequence[str | int]) -> str:
    head, *rest = location or ("body",)
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in rest)
    return ("$" if head == "body" else str(head)) + "".join(parts)


MODEL_KEY = "x-model"


@dataclass(frozen=True)
class SchemaOf:
    """Gives a field the schema of a model without the model's checks, where other rules check the value.

    The OpenAPI document has a reference to the model in the place of MODEL_KEY.
    """

    model: type[BaseModel]

    def __get_pydantic_json_schema__(self, _: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        del handler
        return {MODEL_KEY: self.model.__name__}
