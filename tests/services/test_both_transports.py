"""Every call of gRPC has the answer, or the refusal, that REST has for the same call.

Requests are written once, as REST takes them; both calls are made of them by the descriptors and the routes.
"""

import json
import re
import time
from typing import Any

import grpc
import httpx
import pytest
from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass
from nocturne.v1 import asset_service_pb2, render_service_pb2
from nocturne_api.errors import INTERNAL, TABLE
from nocturne_api.grpc.failures import PROBLEM_KEY
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.render_warnings import RenderWarning, UnmetPart, WarningKind

from tests.services import coordinator_acts
from tests.services.test_contract import ROOT, ROUTES
from tests.services.test_tiles import TILE, WIDTH, Committer, sums_of

METHODS = {
    method.name: method
    for file in (render_service_pb2.DESCRIPTOR, asset_service_pb2.DESCRIPTOR)
    for service in file.services_by_name.values()
    for method in service.methods
}

_ID = "the render's own"
_SHA256 = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"

# What each call is asked. Repeating a call changes nothing, so REST can be asked the same after gRPC.
_ASKED: dict[str, list[dict[str, Any]]] = {
    "CreateRender": [{"request_id": "new", "stop": {"cpu_seconds": 60.0}, "tags": ["b"], "priority": 7}],
    "GetRender": [{"id": _ID}],
    "ListRenders": [{}, {"page_size": 1}, {"tag": "a"}, {"group": "none"}, {"search": "lamp queued"}],
    "CancelRender": [{"id": _ID, "request_id": "c"}],
    "PauseRender": [{"id": _ID}],
    "ResumeRender": [{"id": _ID}],
    "ExtendRender": [
        {"id": _ID, "samples": 64, "stop": {"relative_error": 0.5, "until": "07:00 Europe/Berlin"}},
        {"id": _ID, "drop": ["wall_seconds"]},
    ],
    "SetPriority": [{"id": _ID, "priority": 9}],
    "SetTags": [{"id": _ID, "tags": ["b", "c"]}, {"id": _ID, "tags": []}],
    "LookFirst": [{"id": _ID, "region": {"x": 1, "y": 2, "width": 3, "height": 4}}, {"id": _ID}],
    "ReplayRender": [{"id": _ID, "request_id": "again"}],
    "ExplainRender": [{"id": _ID}],
    "ReadRegion": [{"id": _ID}, {"id": _ID, "region": {"x": 28, "y": 4, "width": 8, "height": 8}}],
    "GetConvergence": [{"id": _ID}],
    "ListWorkers": [{}],
    "DrainWorker": [{"id": "w1"}],
    "CreateWebhook": [{"url": "https://example.org/x"}],
    "ListWebhooks": [{}],
    "BatchMissing": [{"sha256": [_SHA256]}],
}
_REFUSED: dict[str, list[dict[str, Any]]] = {
    "CreateRender": [{"width": 0, "stop": {"relative_error": -1.0}}, {"request_id": "first", "samples": 8}],
    "Preflight": [{"width": 0, "height": 9, "error": 1.5, "budget_seconds": 1e9}],
    "ListRenders": [{"page_token": "?"}],
    "ExtendRender": [{"id": _ID, "samples": 1}, {"id": _ID, "drop": ["patience"]}],
    "SetPriority": [{"id": _ID, "priority": 1001}],
    "SetTags": [{"id": _ID, "tags": ["a,b"]}],
    "LookFirst": [{"id": _ID, "region": {"x": 40, "y": 0, "width": 1, "height": 1}}],
    "ReplayRender": [{"id": _ID, "request_id": ""}],
    "ReadRegion": [{"id": _ID, "region": {"x": 40, "y": 0, "width": 1, "height": 1}}],
    "CreateWebhook": [{"url": "http://127.0.0.1/"}],
    "BatchMissing": [{"sha256": ["abc"]}],
    "DeleteRender": [{"id": _ID}],
}
_ONCE = {"DeleteRender", "DeleteWebhook", "ReleaseWorker"}
# Their tests are below, in test_assets.py and, for preflights, which take long, in test_preflight.py.
_OTHERWISE = {"WatchRender", "WatchRenders", "FetchImage", "Upload", "Fetch", "Preflight"}


@pytest.fixture
async def render_id(body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder) -> str:
    """A render that has something in every field, among a worker, a webhook and another render."""
    asked = {**body, "tags": ["a"], "stop": {"wall_seconds": 60.0, "until": "08:00 Europe/Berlin"}}
    render = (await rest.post("/v1/renders", json=asked)).json()
    assert (await rest.post("/v1/renders", json={**body, "request_id": "second"})).status_code == 201
    assert (await rest.post("/v1/webhooks", json={"url": "https://example.org/1"})).status_code == 201
    committer = Committer(folder)
    committer.commit(render["id"], {0: (16, sums_of(16, TILE), 3), 1: (8, sums_of(8, WIDTH - TILE), 0)})
    committer.ownership.release()
    warnings = [
        RenderWarning(WarningKind.SCENE, "$.surfaces[0].shape: bounds a body, and is open").to_json(),
        RenderWarning(
            WarningKind.MISSING_IN_PARTS, "may be missing", (UnmetPart(8, 0, 8, 4, 0.25),)
        ).to_json(),
    ]
    folder.database.execute(
        """UPDATE render SET state = 'QUEUED', started = created, reason = 'so', photons = 9600,
               rays = 1099511627776, relative_error = 0.25, error_warning = 'so', target_unreachable = 'no',
               warnings = ?
           WHERE id = ?""",
        (json.dumps(warnings), render["id"]),
    )
    folder.database.execute(
        "INSERT INTO error_point VALUES (?, ?, 4800, 4.0, 0.125, 0.25, 70.0)",
        (render["id"], render["created"] + 2.5),
    )
    folder.database.execute(
        "INSERT INTO worker VALUES ('w1', 1, 2, 10, 20, 5.5, 3, 1.0, ?, 'a1')", (time.time(),)
    )
    coordinator_acts.picture(folder, render["id"], bytes(range(256)) * 3000)
    return str(render["id"])


def _message(method: str, asked: dict[str, Any]) -> Message:
    kind = GetMessageClass(METHODS[method].input_type)
    fields = {name: value for name, value in asked.items() if name != "scene"}
    if "scene" in asked:
        fields["scene_json"] = json.dumps(asked["scene"], indent=1)
        if kind.DESCRIPTOR.fields_by_name["scene_json"].type == FieldDescriptor.TYPE_BYTES:
            fields["scene_json"] = fields["scene_json"].encode()
    return kind(**fields)


def _method(channel: grpc.aio.Channel, name: str) -> Any:
    method = METHODS[name]
    coders = (
        GetMessageClass(method.input_type).SerializeToString,
        GetMessageClass(method.output_type).FromString,
    )
    make = {
        (False, False): channel.unary_unary,
        (False, True): channel.unary_stream,
        (True, False): channel.stream_unary,
    }[method.client_streaming, method.server_streaming]
    return make(f"/{method.containing_service.full_name}/{name}", *coders)


async def _by_rest(rest: httpx.AsyncClient, method: str, asked: dict[str, Any]) -> httpx.Response:
    verb, path = ROUTES[method]
    fields = dict(asked)
    for name in re.findall(r"{(\w+)}", path):
        path = path.replace(f"{{{name}}}", fields.pop(name if name in fields else "id"))
    fields |= fields.pop("region", {})
    if verb == "post":
        return await rest.post(path, json=fields)
    return await rest.request(verb, path, params=fields)


def _plain(message: Message) -> dict[str, Any]:
    """As JSON of REST has it: states without their prefix, null for absent values."""
    found: dict[str, Any] = {}
    for field in message.DESCRIPTOR.fields:
        value = getattr(message, field.name)
        if field.is_repeated:
            found[field.name] = [_plain(each) if field.message_type else each for each in value]
        elif field.has_presence and not message.HasField(field.name):
            found[field.name] = None
        elif field.message_type:
            found[field.name] = _plain(value)
        elif field.enum_type:
            found[field.name] = field.enum_type.values_by_number[value].name.removeprefix("RENDER_STATE_")
        else:
            found[field.name] = value
    return found


def _filled(method: str, asked: dict[str, Any], body: dict[str, Any], render_id: str) -> dict[str, Any]:
    whole = body if method == "CreateRender" else {}
    whole = {"scene": body["scene"]} if method == "Preflight" else whole
    return {**whole, **asked} | ({"id": render_id} if asked.get("id") == _ID else {})


def test_every_call_is_asked() -> None:
    assert set(METHODS) == set(_ASKED) | _ONCE | _OTHERWISE
    assert set(METHODS) == set(ROUTES)


@pytest.mark.parametrize(("method", "asked"), [(name, each) for name in _ASKED for each in _ASKED[name]])
async def test_a_call_has_the_answer_of_rest(
    method: str,
    asked: dict[str, Any],
    body: dict[str, Any],
    render_id: str,
    rest: httpx.AsyncClient,
    channel: grpc.aio.Channel,
) -> None:
    if method == "ResumeRender":
        await rest.post(f"/v1/renders/{render_id}:pause")
    asked = _filled(method, asked, body, render_id)
    answer = _plain(await _method(channel, method)(_message(method, asked)))
    expected = await _by_rest(rest, method, asked)
    assert expected.status_code < 300, expected.text
    same = expected.json() if expected.content else {}
    if method == "CreateWebhook":
        for each in (answer, same):
            assert each["secret"].startswith("whsec_")
            del each["id"], each["secret"], each["created"]
    if method == "ListWebhooks":
        # A message that is sent meanwhile changes the list: between two equal answers nothing did.
        before = None
        while before != same:
            before = same
            answer = _plain(await _method(channel, method)(_message(method, asked)))
            same = (await _by_rest(rest, method, asked)).json()
        # One message serves for webhooks with and without their secret.
        assert [each.pop("secret") for each in answer["webhooks"]] == [""]
    assert answer == same


_REFUSALS = [
    *((name, each) for name in _REFUSED for each in _REFUSED[name]),
    *(
        (name, {**(_REFUSED.get(name, _ASKED.get(name)) or [{}])[0], "id": "r-none"})
        for name, method in METHODS.items()
        if "id" in method.input_type.fields_by_name and not method.server_streaming
    ),
]


@pytest.mark.parametrize(("method", "asked"), _REFUSALS)
async def test_a_call_is_refused_as_by_rest(
    method: str,
    asked: dict[str, Any],
    body: dict[str, Any],
    render_id: str,
    rest: httpx.AsyncClient,
    channel: grpc.aio.Channel,
) -> None:
    asked = _filled(method, asked, body, render_id)
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await _method(channel, method)(_message(method, asked))
    expected = await _by_rest(rest, method, asked)
    _assert_same_refusal(caught.value, expected)


def _assert_same_refusal(error: grpc.aio.AioRpcError, expected: httpx.Response) -> None:
    problem = expected.json()
    assert {key: problem[key] for key in ("reason", "detail", "problems")} == json.loads(
        dict(error.trailing_metadata() or ())[PROBLEM_KEY]
    )
    status, code = STATUS[problem["reason"]]
    assert (expected.status_code, error.code().name, error.details()) == (status, code, problem["detail"])


def _table_of_the_page() -> dict[str, tuple[int, str]]:
    page = (ROOT / "docs" / "reference" / "api.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([A-Z_]+) \| .* \| (\d+) \| ([A-Z_]+) \|$", page, re.MULTILINE)
    return {reason: (int(status), code) for reason, status, code in rows}


STATUS = _table_of_the_page()


def test_errors_are_those_of_the_page() -> None:
    kinds = [*(kind for _, kind in TABLE), INTERNAL]
    assert {kind.reason: (kind.http_status, kind.grpc_status.name) for kind in kinds} == STATUS


@pytest.mark.parametrize("name", sorted(_ONCE))
async def test_a_call_that_succeeds_once_does_it_as_by_rest(
    name: str,
    render_id: str,
    rest: httpx.AsyncClient,
    channel: grpc.aio.Channel,
    folder: DataFolder,
) -> None:
    coordinator_acts.finish(folder, render_id)
    await rest.post("/v1/workers/w1:drain")
    webhook = (await rest.get("/v1/webhooks")).json()["webhooks"][0]["id"]
    asked = {"id": {"DeleteRender": render_id, "DeleteWebhook": webhook, "ReleaseWorker": "w1"}[name]}
    assert await _method(channel, name)(_message(name, asked)) == GetMessageClass(METHODS[name].output_type)()
    gone = await _by_rest(rest, name, asked)
    assert gone.status_code == 404
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await _method(channel, name)(_message(name, asked))
    _assert_same_refusal(caught.value, gone)


@pytest.mark.parametrize(("name", "asked"), [("WatchRender", {"id": _ID}), ("WatchRenders", {})])
async def test_streams_have_the_states_of_rest(
    name: str,
    asked: dict[str, Any],
    render_id: str,
    rest: httpx.AsyncClient,
    channel: grpc.aio.Channel,
    folder: DataFolder,
) -> None:
    asked = {"id": render_id} if asked else {}
    path = ROUTES[name][1].format(render_id=render_id)
    call = _method(channel, name)(_message(name, asked))
    states = aiter(call)
    async with rest.stream("GET", path) as stream:
        expected = (json.loads(line[6:]) async for line in stream.aiter_lines() if line.startswith("data: "))
        for _ in range(1 if asked else 2):
            assert _plain(await anext(states)) == await anext(expected)
        coordinator_acts.finish(folder, render_id)
        last = _plain(await anext(states))
        assert last == await anext(expected)
    assert last["state"] == "SUCCEEDED"
    call.cancel()


@pytest.mark.parametrize("name", ["WatchRender", "FetchImage"])
async def test_streams_are_refused_as_by_rest(
    name: str, rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    asked = {"id": "r-none"}
    call = _method(channel, name)(_message(name, asked | ({"kind": 2} if name == "FetchImage" else {})))
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await anext(aiter(call))
    _assert_same_refusal(caught.value, await _by_rest(rest, name, asked))


@pytest.mark.parametrize(("kind", "file"), [(1, "preview.png"), (2, "image.exr")])
async def test_images_have_the_bytes_of_rest(
    kind: int, file: str, render_id: str, rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    expected = await rest.get(f"/v1/renders/{render_id}/{file}")
    assert expected.status_code == 200
    chunks = [
        each
        async for each in _method(channel, "FetchImage")(
            _message("FetchImage", {"id": render_id, "kind": kind})
        )
    ]
    assert b"".join(chunk.data for chunk in chunks) == expected.content
    first, *others = [chunk.etag for chunk in chunks]
    assert others == [""] * (len(chunks) - 1)
    # The image of a render that runs is made for each call, with a new ETag.
    assert first == expected.headers["etag"] or (first and file == "image.exr")


async def test_an_image_kind_must_be_given(channel: grpc.aio.Channel) -> None:
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await anext(aiter(_method(channel, "FetchImage")(_message("FetchImage", {"id": "none"}))))
    assert caught.value.code() == grpc.StatusCode.INVALID_ARGUMENT
