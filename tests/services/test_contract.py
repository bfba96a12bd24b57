"""One contract: whatever is made from the REST models is as they are, and gRPC says the same."""

import importlib.util
import json
import re
from datetime import UTC, datetime
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from google.protobuf.descriptor import Descriptor, FieldDescriptor
from nocturne.v1 import asset_service_pb2, render_service_pb2
from nocturne_api.models import (
    assets,
    measurements,
    problems,
    render_requests,
    renders,
    scenes,
    session,
    webhooks,
    workers,
)
from nocturne_api.models.base import Answer, RequestBody
from nocturne_api.rest import routes_page
from nocturne_api.rest.app import described_app
from nocturne_coordinator.dispatch.stopping import stop_conditions
from nocturne_scene.document.read import check_document

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / "docs" / "reference"
DESCRIPTION: dict[str, Any] = json.loads((REFERENCE / "openapi.json").read_text(encoding="utf-8"))
SCHEMAS: dict[str, Any] = DESCRIPTION["components"]["schemas"]
OPERATIONS = {
    (method, path): operation
    for path, methods in DESCRIPTION["paths"].items()
    for method, operation in methods.items()
}


def test_the_committed_description_is_that_of_the_service() -> None:
    """`make contract` writes it."""
    assert json.loads(json.dumps(described_app().openapi())) == DESCRIPTION


def test_the_page_of_routes_is_that_of_the_description() -> None:
    """`make contract` writes it."""
    assert routes_page.page(described_app().openapi()) == (REFERENCE / "routes.md").read_text(
        encoding="utf-8"
    )


def test_the_tables_of_the_api_page_name_routes_and_methods() -> None:
    """Rows of the page begin with routes, in which `...` is a render's address and ID any id."""
    page = (REFERENCE / "api.md").read_text(encoding="utf-8")
    found = set()
    for method, path in re.findall(r"`(GET|POST|PUT|DELETE) ([^`\s?]+)", page):
        whole = re.sub(r"^\.\.\.", "/v1/renders/{id}", path).replace("/ID", "/{id}")
        found.add((method.lower(), re.sub(r"\{\w+\}", "{}", whole)))
    known = {(method, re.sub(r"\{\w+\}", "{}", path)) for method, path in OPERATIONS}
    assert len(found) > 15
    assert not found - known
    methods = {method for _, method in re.findall(r"^\| (`[A-Z]+ .*?) \| `(\w+)`", page, re.MULTILINE)}
    assert methods <= set(ROUTES)


def _generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        "generate_models", ROOT / "services" / "client" / "generate_models.py"
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_clients_models_are_those_of_the_description() -> None:
    """`make contract` writes them."""
    committed = ROOT / "services" / "client" / "nocturne_client" / "contract.py"
    assert _generator().module(DESCRIPTION) == committed.read_text(encoding="utf-8")


# --- gRPC ---

MESSAGES: dict[str, Descriptor] = {
    name: message
    for file in (render_service_pb2.DESCRIPTOR, asset_service_pb2.DESCRIPTOR)
    for name, message in file.message_types_by_name.items()
}

# Messages whose schema has another name.
_OTHER_NAME = {
    "Webhook": "NewWebhook",
    "ListRendersResponse": "RenderPage",
    "ListWorkersResponse": "WorkerList",
    "ListWebhooksResponse": "WebhookList",
    "GetConvergenceResponse": "Convergence",
    "ExplainRenderResponse": "Explanation",
    "CancelRenderRequest": "RenderActionRequest",
    "PauseRenderRequest": "RenderActionRequest",
    "ResumeRenderRequest": "RenderActionRequest",
}
# Messages without a schema: what REST says by addresses, parameters, empty answers or plain bytes.
_NO_SCHEMA = {
    *("GetRenderRequest", "ListRendersRequest", "WatchRenderRequest", "WatchRendersRequest"),
    *("DeleteRenderRequest", "DeleteRenderResponse", "ExplainRenderRequest", "GetConvergenceRequest"),
    *("ReadRegionRequest", "FetchImageRequest", "ImageChunk", "FetchRequest", "Chunk", "UploadRequest"),
    *("ListWorkersRequest", "ReleaseWorkerRequest", "ReleaseWorkerResponse"),
    *("DrainWorkerRequest", "DrainWorkerResponse"),
    *("ListWebhooksRequest", "DeleteWebhookRequest", "DeleteWebhookResponse", "PreflightResponse"),
}
# Fields that may differ: (message, field of the message, or "", field of the schema, or "").
_DIFFERENCES = {
    # Documents are JSON, which protobuf carries as text.
    ("CreateRenderRequest", "scene_json", "scene"),
    ("PreflightRequest", "scene_json", "scene"),
    # One message serves for webhooks with and without their secret, which is shown once.
    ("ListWebhooksResponse", "webhooks", "webhooks"),
    # gRPC can leave a message out; a REST body with zeros says the same.
    *(("LookFirstRequest", "region", ""), ("LookFirstRequest", "", "x"), ("LookFirstRequest", "", "y")),
    *(("LookFirstRequest", "", "width"), ("LookFirstRequest", "", "height")),
}
# Of requests; REST has it in the address.
_IN_ADDRESS = "id"


def _schema_of(message: str) -> str:
    return _OTHER_NAME.get(message, message)


def _fields_of_message(message: Descriptor) -> dict[str, tuple[str, bool]]:
    """Type and whether it may be absent."""
    return {field.name: (_type_of_field(field), _may_be_absent(field)) for field in message.fields}


def _type_of_field(field: FieldDescriptor) -> str:
    if field.enum_type is not None:
        kind = field.enum_type.name
    elif field.message_type is not None:
        kind = _schema_of(field.message_type.name)
    else:
        kind = {
            field.CPPTYPE_STRING: "string",
            field.CPPTYPE_BOOL: "boolean",
            field.CPPTYPE_DOUBLE: "number",
            field.CPPTYPE_UINT32: "integer",
            field.CPPTYPE_UINT64: "integer",
        }[field.cpp_type]
    return f"list of {kind}" if field.is_repeated else kind


def _may_be_absent(field: FieldDescriptor) -> bool:
    # Protobuf distinguishes an absent message from an empty one. Messages of answers are always present.
    return field.name == "look_first" or field.containing_oneof is not None


def _fields_of_schema(name: str) -> dict[str, tuple[str, bool]]:
    return {field: _type_of_schema(about) for field, about in SCHEMAS[name]["properties"].items()}


def _type_of_schema(schema: dict[str, Any]) -> tuple[str, bool]:
    if "anyOf" in schema:
        (one,) = [each for each in schema["anyOf"] if each.get("type") != "null"]
        return _type_of_schema(one)[0], True
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        # Request and answer have the same fields, except for the time that `until` resolves to.
        return ("StopConditions" if name == "StopRequest" else name), False
    if schema["type"] == "array":
        return f"list of {_type_of_schema(schema['items'])[0]}", False
    return schema["type"], False


@pytest.mark.parametrize("name", sorted(set(MESSAGES) - _NO_SCHEMA))
def test_messages_have_the_fields_of_the_schemas(name: str) -> None:
    """Names, types and optional fields agree."""
    message, schema = _fields_of_message(MESSAGES[name]), _fields_of_schema(_schema_of(name))
    for of, in_message, in_schema in _DIFFERENCES:
        if of == name:
            # A difference that is none any more is an error too.
            message.pop(in_message) if in_message else None
            schema.pop(in_schema) if in_schema else None
    if name.endswith("Request"):
        message.pop(_IN_ADDRESS, None)
    assert message == schema


def test_the_tables_of_differences_are_short_and_true() -> None:
    assert set(MESSAGES) >= _NO_SCHEMA | set(_OTHER_NAME)
    assert not _NO_SCHEMA & SCHEMAS.keys()
    assert {*_OTHER_NAME.values()} <= SCHEMAS.keys()


def test_states_are_the_same() -> None:
    names = set(render_service_pb2.RenderState.keys()) - {"RENDER_STATE_UNSPECIFIED"}
    assert {name.removeprefix("RENDER_STATE_") for name in names} == set(SCHEMAS["RenderState"]["enum"])


def test_every_method_has_a_route_and_a_request_of_its_own() -> None:
    methods = {
        method.name: method
        for file in (render_service_pb2.DESCRIPTOR, asset_service_pb2.DESCRIPTOR)
        for service in file.services_by_name.values()
        for method in service.methods
    }
    for name, method in methods.items():
        assert method.input_type.name == f"{name}Request"
    found = {name: ROUTES[name] for name in methods}
    missing = {name: route for name, route in found.items() if route not in OPERATIONS}
    assert not missing
    assert set(ROUTES) == set(methods)


ROUTES = {
    "CreateRender": ("post", "/v1/renders"),
    "Preflight": ("post", "/v1/preflights"),
    "GetRender": ("get", "/v1/renders/{render_id}"),
    "ListRenders": ("get", "/v1/renders"),
    "CancelRender": ("post", "/v1/renders/{render_id}:cancel"),
    "DeleteRender": ("delete", "/v1/renders/{render_id}"),
    "PauseRender": ("post", "/v1/renders/{render_id}:pause"),
    "ResumeRender": ("post", "/v1/renders/{render_id}:resume"),
    "ExtendRender": ("post", "/v1/renders/{render_id}:extend"),
    "SetPriority": ("post", "/v1/renders/{render_id}:setPriority"),
    "SetTags": ("post", "/v1/renders/{render_id}:setTags"),
    "LookFirst": ("post", "/v1/renders/{render_id}:lookFirst"),
    "ReplayRender": ("post", "/v1/renders/{render_id}:replay"),
    "ExplainRender": ("get", "/v1/renders/{render_id}/explanation"),
    "ReadRegion": ("get", "/v1/renders/{render_id}/reading"),
    "GetConvergence": ("get", "/v1/renders/{render_id}/convergence"),
    "WatchRender": ("get", "/v1/renders/{render_id}/events"),
    "WatchRenders": ("get", "/v1/events"),
    "FetchImage": ("get", "/v1/renders/{render_id}/image.exr"),
    "ListWorkers": ("get", "/v1/workers"),
    "DrainWorker": ("post", "/v1/workers/{worker_id}:drain"),
    "ReleaseWorker": ("post", "/v1/workers/{worker_id}:release"),
    "CreateWebhook": ("post", "/v1/webhooks"),
    "ListWebhooks": ("get", "/v1/webhooks"),
    "DeleteWebhook": ("delete", "/v1/webhooks/{webhook_id}"),
    "BatchMissing": ("post", "/v1/assets:batchMissing"),
    "Upload": ("put", "/v1/assets/{sha256}"),
    # Workers fetch over gRPC; REST tells whether a file is there.
    "Fetch": ("head", "/v1/assets/{sha256}"),
}


# --- what routes say of themselves ---


@pytest.mark.parametrize(("method", "path"), sorted(OPERATIONS))
def test_every_route_declares_its_answers(method: str, path: str) -> None:
    operation = OPERATIONS[method, path]
    assert operation["description"]
    answers = operation["responses"]
    (success,) = [status for status in answers if status.startswith("2")]
    if success != "204" and method != "head":
        contents = answers[success]["content"]
        # A stream describes each of its items.
        assert all(content.get("schema") or content.get("itemSchema") for content in contents.values())
    if path.startswith("/v1"):
        assert {"401", "403", "422", "429", "500", "503"} <= answers.keys()
    for status, answer in answers.items():
        if status >= "400" and (path, status) != ("/readyz", "503"):
            named = DESCRIPTION["components"]["responses"][answer["$ref"].rpartition("/")[2]]
            content = named["content"]["application/problem+json"]
            assert content["schema"] == {"$ref": "#/components/schemas/ProblemDetails"}
            for example in content["examples"].values():
                assert problems.ProblemDetails.model_validate(example["value"]).status == int(status)


@pytest.mark.parametrize("name", sorted(SCHEMAS))
def test_every_schema_says_what_it_is(name: str) -> None:
    assert SCHEMAS[name].get("description"), name


_MODELS: list[type[Answer | RequestBody]] = [
    model
    for module in (
        assets,
        measurements,
        problems,
        render_requests,
        renders,
        scenes,
        session,
        webhooks,
        workers,
    )
    for model in vars(module).values()
    if isinstance(model, type)
    and issubclass(model, Answer | RequestBody)
    and model.__module__ == module.__name__
]


@pytest.mark.parametrize("model", _MODELS, ids=lambda model: model.__name__)
def test_examples_are_valid(model: type[Answer | RequestBody]) -> None:
    for example in SCHEMAS[model.__name__].get("examples", []):
        found = model.model_validate(example)
        if issubclass(model, Answer):
            assert found.model_dump(mode="json") == example
        if isinstance(example.get("scene"), dict):
            check_document(example["scene"])
        if "stop" in example and issubclass(model, RequestBody):
            stop_conditions(example["stop"], datetime.now(UTC))


def test_the_schema_of_stop_conditions_is_what_is_checked() -> None:
    asked = {name: 0.5 for name in SCHEMAS["StopRequest"]["properties"] if name != "until"}
    stop_conditions({**asked, "until": "07:00 Europe/Berlin"}, datetime.now(UTC))
    with pytest.raises(Exception, match="is not known; expected") as refused:
        stop_conditions({"surely unknown": 1}, datetime.now(UTC))
    expected = str(refused.value).partition("expected ")[2].split(", ")
    assert set(expected) == SCHEMAS["StopRequest"]["properties"].keys()
