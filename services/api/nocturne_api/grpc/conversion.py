"""Models become messages, and messages become models, by the names of their fields.

The models are those of REST, which are the contract. tests/services/test_contract.py compares each message
with its model, so that no field of either is lost here.
"""

from typing import Any, TypeVar

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message
from nocturne_scene.document.json_text import decode_json
from pydantic import BaseModel

from nocturne_api.models.base import RequestBody, SchemaOf, validated

_Message = TypeVar("_Message", bound=Message)
_Body = TypeVar("_Body", bound=RequestBody)


def message_of(answer: object, kind: type[_Message]) -> _Message:
    """An answer of an operation as the message of this class; None as the empty one."""
    if isinstance(answer, kind):
        return answer
    return kind(**_contents(answer, kind.DESCRIPTOR))


def _contents(answer: object, descriptor: Any) -> dict[str, Any]:
    found = {}
    for field in descriptor.fields:
        value = getattr(answer, field.name, None)
        if value is not None:
            found[field.name] = (
                [_content(each, field) for each in value] if field.is_repeated else _content(value, field)
            )
    return found


def _content(value: Any, field: FieldDescriptor) -> Any:
    if field.message_type is not None:
        return _contents(value, field.message_type)
    if field.enum_type is not None:
        return field.enum_type.values[0].name.removesuffix("UNSPECIFIED") + value
    return value


def body_of(message: Message, kind: type[_Body]) -> _Body:
    """A request as the body that REST takes for it; raises InputError. Field `a_json` has the JSON of `a`."""
    fields = message.DESCRIPTOR.fields_by_name
    found: dict[str, Any] = {}
    for name, about in kind.model_fields.items():
        schemas = [each.model for each in about.metadata if isinstance(each, SchemaOf)]
        if f"{name}_json" in fields:
            found[name] = decode_json(getattr(message, f"{name}_json"))
        elif schemas:
            found[name] = given(getattr(message, name), schemas[0])
        else:
            value = getattr(message, name)
            found[name] = [*value] if fields[name].is_repeated else value
    return validated(kind, found)


def given(message: Message, kind: type[BaseModel]) -> dict[str, Any]:
    """Fields of the model that the message gives; fields that are 0 or empty are not given."""
    return {field.name: value for field, value in message.ListFields() if field.name in kind.model_fields}
