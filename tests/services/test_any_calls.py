"""Arbitrary calls never cause an internal error, and the service keeps running."""

import copy
import itertools
import json
from collections.abc import Iterator
from typing import Any

import grpc
import httpx
import pytest
import schemathesis
from google.protobuf import message_factory
from hypothesis import given
from hypothesis import strategies as st
from nocturne.v1 import asset_service_pb2, render_service_pb2
from nocturne_api.service import Service, Settings

from tests.fuzzing import tried
from tests.services.conftest import SCENE
from tests.services.served import served

_QUIETLY = tried(examples=2)

# Bytes like any other.
schemathesis.serializer.alias("image/x-exr", "application/octet-stream")


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("any")
    with served(Settings(data=folder / "data", web=folder / "web", port=0, grpc_port=0)) as service:
        yield service


@pytest.fixture(scope="module")
def url(service: Service) -> str:
    return f"http://127.0.0.1:{service.port}"


def _create_body(request_id: str) -> dict[str, Any]:
    return {
        "request_id": request_id,
        "name": "lamp",
        "scene": copy.deepcopy(SCENE),
        "width": 40,
        "height": 30,
        "samples": 16,
    }


@pytest.fixture(scope="module")
def render_id(url: str) -> str:
    """A render that calls can be about."""
    answer = httpx.post(f"{url}/v1/renders", json=_create_body("known"), timeout=300, trust_env=False)
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


@pytest.fixture(scope="module")
def described(url: str) -> Any:
    """The service's own description. Streams of events do not end, and have a separate test."""
    return schemathesis.openapi.from_url(f"{url}/openapi.json").exclude(path_regex="/events$")


def _labels(described: Any) -> list[str]:
    return [operation.ok().label for operation in described.get_all_operations()]


def test_any_call_by_the_description(described: Any, render_id: str) -> None:
    for operation in described.get_all_operations():

        @_QUIETLY
        @given(case=operation.ok().as_strategy(), known=st.booleans())
        def call(case: Any, known: bool) -> None:
            if known and "render_id" in (case.path_parameters or {}):
                case.path_parameters["render_id"] = render_id
            answer = case.call(timeout=300)
            # Nobody merges here, and /readyz says so.
            stated = {503} if case.path == "/readyz" else set()
            assert answer.status_code < 500 or answer.status_code in stated, (
                case.as_curl_command(),
                answer.text,
            )

        call()


def test_the_description_covers_what_there_is(described: Any) -> None:
    labels = _labels(described)
    assert {"POST /v1/renders", "PUT /v1/assets/{sha256}", "POST /v1/renders/{render_id}:extend"} <= {*labels}
    assert len(labels) > 15


@_QUIETLY
@given(
    render=st.text(), last=st.text(st.characters(codec="latin-1", exclude_categories=["Cc"])).map(str.strip)
)
def test_any_stream_of_events(url: str, render: str, last: str) -> None:
    path = httpx.URL(url).copy_with(raw_path=b"/v1/renders/" + _quoted(render) + b"/events")
    with httpx.stream(
        "GET", path, headers={b"Last-Event-ID": last.encode("latin-1")}, trust_env=False
    ) as answer:
        assert answer.status_code < 500


def _quoted(text: str) -> bytes:
    return "".join(f"%{byte:02X}" for byte in text.encode("utf-8", "replace")).encode()


_values: st.SearchStrategy[Any] = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda children: (
        st.lists(children, max_size=4) | st.dictionaries(st.text(max_size=8), children, max_size=4)
    ),
    max_leaves=8,
)


@_QUIETLY
@given(st.data())
def test_any_change_of_a_scene(url: str, data: st.DataObject) -> None:
    body = _create_body(data.draw(st.text(min_size=1, max_size=12)))
    for _ in range(data.draw(st.integers(1, 3))):
        place: Any = body["scene"]
        while True:
            key = data.draw(
                st.sampled_from(list(place) if isinstance(place, dict) else list(range(len(place))))
            )
            if not isinstance(place[key], dict | list) or not place[key] or data.draw(st.integers(0, 3)) == 0:
                break
            place = place[key]
        place[key] = data.draw(_values)
    text = json.dumps(body).encode("utf-8", "surrogatepass")
    answer = httpx.post(f"{url}/v1/renders", content=text, timeout=300, trust_env=False)
    assert answer.status_code < 500, (text, answer.text)


_METHODS = [
    (f"/{service.full_name}/{method.name}", method)
    for file in (render_service_pb2.DESCRIPTOR, asset_service_pb2.DESCRIPTOR)
    for service in file.services_by_name.values()
    for method in service.methods
]


def _content(field: Any) -> st.SearchStrategy[Any]:
    """Any content of a field."""
    if field.message_type is not None:
        return _message(field.message_type)
    if field.enum_type is not None:
        return st.integers(-1, 9)
    if field.type == field.TYPE_BYTES:
        return st.binary(max_size=40)
    return {
        field.CPPTYPE_STRING: st.text(st.characters(codec="utf-8"), max_size=40),
        field.CPPTYPE_DOUBLE: st.floats(),
        field.CPPTYPE_BOOL: st.booleans(),
        field.CPPTYPE_INT32: st.integers(-(2**31), 2**31 - 1),
        field.CPPTYPE_UINT32: st.integers(0, 2**32 - 1),
        field.CPPTYPE_INT64: st.integers(-(2**63), 2**63 - 1),
        field.CPPTYPE_UINT64: st.integers(0, 2**64 - 1),
    }[field.cpp_type]


def _message(message: Any) -> st.SearchStrategy[Any]:
    """Any message of a kind. Of fields that exclude each other, the last one that is given counts."""
    fields = {}
    for field in message.fields:
        content = _content(field)
        fields[field.name] = st.lists(content, max_size=3) if field.is_repeated else content
    make = message_factory.GetMessageClass(message)
    return st.fixed_dictionaries({}, optional=fields).map(lambda values: make(**values))


@pytest.mark.parametrize(("path", "method"), _METHODS, ids=[path for path, _ in _METHODS])
@_QUIETLY
@given(data=st.data())
def test_any_message(service: Service, render_id: str, path: str, method: Any, data: st.DataObject) -> None:
    def one() -> bytes:
        # Bytes of no form; of the right form, with any content; and about a render that there is.
        kind = data.draw(st.integers(0, 3))
        if kind == 0:
            return data.draw(st.binary(max_size=100))
        message = data.draw(_message(method.input_type))
        if kind > 1 and "id" in method.input_type.fields_by_name:
            message.id = render_id
        return bytes(message.SerializeToString())

    # Without serialisers: any bytes are sent.
    channel: Any = grpc.insecure_channel(f"127.0.0.1:{service.grpc_port}")
    code = grpc.StatusCode.OK
    try:
        if path.endswith("/Upload"):
            channel.stream_unary(path)(iter([one() for _ in range(3)]), timeout=20)
        elif any(word in path for word in ("Watch", "Fetch")):
            list(itertools.islice(channel.unary_stream(path)(one(), timeout=0.2), 2))
        else:
            channel.unary_unary(path)(one(), timeout=300)
    except grpc.RpcError as error:
        code = error.code()
    finally:
        channel.close()
    assert code not in (grpc.StatusCode.INTERNAL, grpc.StatusCode.UNKNOWN)


def test_it_lives_on(url: str) -> None:
    assert httpx.get(f"{url}/readyz?exclude=merging", trust_env=False).status_code == 200
