"""What all models of the contract have in common."""

from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler
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
