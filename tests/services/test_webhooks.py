"""Webhooks: real receivers, signatures checked by the specification's own library, and nowhere private."""

import asyncio
import ipaddress
import logging
import ssl
import threading
import time
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import asynccontextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import grpc
import pytest
import trustme
from nocturne.v1 import render_service_pb2 as pb
from nocturne.v1 import render_service_pb2_grpc
from nocturne_api.service import Service, Settings, open_service
from nocturne_api.webhooks.sender import PAUSES_S, WebhookSender
from nocturne_api.webhooks.targets import TargetRefused, TargetRules
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.errors import InputError
from standardwebhooks import Webhook, WebhookVerificationError

from tests.services.endpoints import grpc_channel, rest_client

HOME = ipaddress.ip_network("127.0.0.1/32")


class Receiver(HTTPServer):
    """Takes messages; answers with `statuses` one after the other, then with 204."""

    def __init__(self, tls: ssl.SSLContext | None = None, *statuses: int) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        if tls is not None:
            self.socket = tls.wrap_socket(self.socket, server_side=True)
        self.statuses = list(statuses)
        self.got: list[tuple[str, dict[str, str], bytes]] = []
        self.location = ""
        self._thread = threading.Thread(
            target=self.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True
        )

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}/hook?key=abc"

    def __enter__(self) -> "Receiver":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()
        self.server_close()

    def handle_error(self, *_: object) -> None:
        """A caller that goes away is no news."""


class _Handler(BaseHTTPRequestHandler):
    def do_POST(self) -> None:
        receiver = self.server
        assert isinstance(receiver, Receiver)
        body = self.rfile.read(int(self.headers["Content-Length"]))
        receiver.got.append((self.path, dict(self.headers.items()), body))
        self.send_response(receiver.statuses.pop(0) if receiver.statuses else 204)
        if receiver.location:
            self.send_header("Location", receiver.location)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        pass


async def until_true(true: Callable[[], bool], seconds: float = 15.0) -> None:
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, "did not happen in time"
        await asyncio.sleep(0.02)


async def until(receiver: Receiver, count: int) -> None:
    await until_true(lambda: len(receiver.got) >= count)


def make_render(folder: DataFolder, render_id: str, owner: str = "") -> None:
    folder.database.execute(
        """INSERT INTO render (id, request_id, request_digest, name, state, width, height, samples,
               scene_sha256, engine, created, ranges_planned, schedule, scene_document, owner)
           VALUES (?, ?, '', 'night', 'RUNNING', 8, 8, 4, '', 3, 1.0, 1, x'', '{}', ?)""",
        (render_id, render_id, owner),
    )


def end(folder: DataFolder, render_id: str, state: str, reason: str = "") -> None:
    folder.database.execute(
        "UPDATE render SET state = ?, reason = ?, ended = 1e9 WHERE id = ?", (state, reason, render_id)
    )


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[DataFolder]:
    folder = DataFolder(tmp_path / "data")
    yield folder
    folder.close()


@pytest.fixture
async def service(folder: DataFolder) -> AsyncIterator[Service]:
    settings = Settings(data=folder.root, web=folder.root, port=0, grpc_port=0, webhook_networks=[HOME])
    service = await open_service(settings)
    await service.start()
    yield service
    await service.stop()


@asynccontextmanager
async def sending(
    folder: DataFolder,
    rules: TargetRules,
    pauses_s: tuple[float, ...] = (0.05, 0.05),
    verify: ssl.SSLContext | bool = True,
) -> AsyncIterator[None]:
    sender = WebhookSender(folder.webhooks, asyncio.to_thread, rules, pauses_s, verify)
    sender.start()
    try:
        yield
    finally:
        await sender.close()


async def test_ends_are_told_and_signed(
    service: Service, folder: DataFolder, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    with Receiver() as receiver:
        async with rest_client(service) as rest:
            made = (await rest.post("/v1/webhooks", json={"url": receiver.url})).json()
            for state in ("SUCCEEDED", "STOPPED_EARLY", "DEGRADED", "FAILED", "CANCELLED", "PAUSED"):
                make_render(folder, f"r-{state}")
                end(folder, f"r-{state}", state, "because")
            await until(receiver, 4)
            await asyncio.sleep(0.3)
            listed = (await rest.get("/v1/webhooks")).json()["webhooks"]
    told = {}
    for path, headers, body in receiver.got:
        assert path == "/hook?key=abc"
        assert headers["Host"] == f"127.0.0.1:{receiver.server_port}"
        message = Webhook(made["secret"]).verify(body, headers)
        with pytest.raises(WebhookVerificationError):
            Webhook(made["secret"]).verify(body + b" ", headers)
        told[message["type"]] = message
    assert set(told) == {"render.succeeded", "render.stopped_early", "render.degraded", "render.failed"}
    assert told["render.degraded"] == {
        "type": "render.degraded",
        "timestamp": "2001-09-09T01:46:40Z",
        "data": {"id": "r-DEGRADED", "name": "night", "state": "DEGRADED", "reason": "because", "doubt": ""},
    }
    assert len({headers["webhook-id"] for _, headers, _ in receiver.got}) == 4
    assert [each["last_outcome"] for each in listed] == ["answered 204"]
    assert "secret" not in listed[0]
    # Neither the secret, nor the address, whose query may be one, is in a log.
    assert "answered 204" in caplog.text
    assert made["secret"] not in caplog.text
    assert made["secret"].removeprefix("whsec_") not in caplog.text
    assert "nocturne_api" in {record.name.split(".")[0] for record in caplog.records}
    ours = [record.getMessage() for record in caplog.records if record.name.startswith("nocturne")]
    assert not any("key=abc" in text for text in ours)


async def test_both_endpoints_make_list_and_delete(service: Service) -> None:
    async with rest_client(service) as rest, grpc_channel(service) as channel:
        stub = render_service_pb2_grpc.RenderServiceStub(channel)
        made = await stub.CreateWebhook(pb.CreateWebhookRequest(url="https://example.org/x"))
        assert made.secret.startswith("whsec_")
        listed = (await rest.get("/v1/webhooks")).json()["webhooks"]
        assert [(each["id"], each["url"]) for each in listed] == [(made.id, made.url)]
        assert [each.id for each in (await stub.ListWebhooks(pb.ListWebhooksRequest())).webhooks] == [made.id]
        assert (await rest.delete(f"/v1/webhooks/{made.id}")).status_code == 204
        assert (await rest.delete(f"/v1/webhooks/{made.id}")).status_code == 404
        with pytest.raises(grpc.aio.AioRpcError, match="there is no webhook"):
            await stub.DeleteWebhook(pb.DeleteWebhookRequest(id=made.id))
        for number in range(20):
            answer = await rest.post("/v1/webhooks", json={"url": f"https://example.org/{number}"})
            assert answer.status_code == 201
        assert (await rest.post("/v1/webhooks", json={"url": "https://example.org/"})).status_code == 422


async def test_an_end_is_told_to_its_owner_only(folder: DataFolder) -> None:
    with Receiver() as mine, Receiver() as other:
        folder.webhooks.create("me", mine.url)
        folder.webhooks.create("you", other.url)
        make_render(folder, "r-1", "me")
        end(folder, "r-1", "FAILED")
        async with sending(folder, TargetRules([HOME])):
            await until(mine, 1)
            await asyncio.sleep(0.2)
    assert (len(mine.got), len(other.got)) == (1, 0)


async def test_what_is_not_taken_comes_again_and_stays_the_same(folder: DataFolder) -> None:
    with Receiver(None, 500, 302) as receiver:
        _, secret = folder.webhooks.create("", receiver.url)
        make_render(folder, "r-1")
        end(folder, "r-1", "SUCCEEDED")
        async with sending(folder, TargetRules([HOME])):
            await until(receiver, 3)
            await asyncio.sleep(1.2)
    assert len(receiver.got) == 3
    assert len({headers["webhook-id"] for _, headers, _ in receiver.got}) == 1
    assert len({body for _, _, body in receiver.got}) == 1
    for _, headers, body in receiver.got:
        Webhook(secret).verify(body, headers)
    assert folder.webhooks.list("")[0].last_outcome == "answered 204"


async def test_it_is_given_up_in_the_end(folder: DataFolder) -> None:
    with Receiver(None, *[503] * 99) as receiver:
        folder.webhooks.create("", receiver.url)
        make_render(folder, "r-1")
        end(folder, "r-1", "SUCCEEDED")
        async with sending(folder, TargetRules([HOME])):
            await until(receiver, 3)
            await asyncio.sleep(1.5)
    assert len(receiver.got) == 3
    assert folder.webhooks.list("")[0].last_outcome == "answered 503; given up"
    assert folder.webhooks.take_due(2e12, 1.0, 9) == []


def test_the_pauses_grow_to_three_days() -> None:
    assert list(PAUSES_S) == sorted(PAUSES_S)
    assert PAUSES_S[0] < 10.0
    assert 2 * 86400.0 < sum(PAUSES_S) < 4 * 86400.0


async def test_one_that_is_gone_is_deleted(folder: DataFolder) -> None:
    with Receiver(None, 410) as receiver:
        folder.webhooks.create("", receiver.url)
        make_render(folder, "r-1")
        end(folder, "r-1", "SUCCEEDED")
        async with sending(folder, TargetRules([HOME])):
            await until(receiver, 1)
            await until_true(lambda: not folder.webhooks.list(""))


async def test_a_message_outlives_the_process(folder: DataFolder) -> None:
    """Noted with the end of the render, sent when there is somebody to send it."""
    with Receiver() as receiver:
        folder.webhooks.create("", receiver.url)
        make_render(folder, "r-1")
        end(folder, "r-1", "SUCCEEDED")
        again = DataFolder(folder.root)
        async with sending(again, TargetRules([HOME])), sending(folder, TargetRules([HOME])):
            await until(receiver, 1)
            await asyncio.sleep(1.2)
        again.close()
    assert len(receiver.got) == 1


async def test_no_redirect_is_followed(folder: DataFolder) -> None:
    with Receiver() as private, Receiver(None, *[307] * 9) as receiver:
        receiver.location = private.url
        folder.webhooks.create("", receiver.url)
        make_render(folder, "r-1")
        end(folder, "r-1", "SUCCEEDED")
        async with sending(folder, TargetRules([HOME])):
            await until(receiver, 2)
    assert private.got == []


PRIVATE = [
    *("127.0.0.1", "127.8.8.8", "0.0.0.0", "10.1.2.3", "172.16.0.1", "192.168.1.1", "169.254.169.254"),  # noqa: S104
    *("100.64.0.1", "224.0.0.1", "255.255.255.255", "192.0.2.1", "198.18.0.1", "240.0.0.1"),
    *("::1", "::", "fe80::1", "fc00::1", "ff02::1", "::ffff:127.0.0.1", "::ffff:10.0.0.1"),
    *("2002:7f00:1::", "64:ff9b::7f00:1", "64:ff9b:1::1", "2001:db8::1", "2001:0:7f00:1::"),
]


@pytest.mark.parametrize("address", PRIVATE)
async def test_private_addresses_are_refused_named_or_not(address: str) -> None:
    async def resolve(*_: object) -> Sequence[str]:
        return ["93.184.215.14", address]

    rules = TargetRules(resolve=resolve)
    with pytest.raises(TargetRefused, match="not a public address"):
        await rules.address(rules.parse("https://name.example/"))
    literal = f"[{address}]" if ":" in address else address
    with pytest.raises(TargetRefused, match="not a public address"):
        await rules.address(rules.parse(f"https://{literal}/"))
    # Who gives it is told at once.
    with pytest.raises(InputError, match=r"\$\.url.*not a public address"):
        rules.admit(f"https://{literal}/")
    rules.admit("https://name.example/")


@pytest.mark.parametrize("host", ["2130706433", "0x7f.1", "0177.0.0.1", "127.1", "localhost"])
async def test_other_spellings_of_this_machine_are_refused(host: str) -> None:
    """What the system's resolver makes of them is what is checked."""
    rules = TargetRules()
    with pytest.raises(TargetRefused):
        await rules.address(rules.parse(f"https://{host}/"))


async def test_public_addresses_are_taken_with_https_only() -> None:
    for address in ("93.184.215.14", "[2606:2800:21f:cb07:6820:80da:af6b:8b2c]"):
        target = TargetRules().parse(f"https://{address}/")
        assert await TargetRules().address(target) == address.strip("[]")
    at_home = TargetRules([HOME])
    with pytest.raises(TargetRefused, match="only https"):
        await at_home.address(at_home.parse("http://93.184.215.14/"))


@pytest.mark.parametrize(
    "url",
    [
        *(
            "",
            "example.org",
            "ftp://example.org/",
            "http://example.org/",
            "https:///x",
            "https://[::",
            "https://a:0/",
        ),
        *(
            "https://user:word@example.org/",
            "https://example.org/#x",
            "https://example.org/ x",
            "https://a:99999/",
        ),
        *("file:///etc/passwd", "https://exämple.org/", "https://example.org/" + 2048 * "x"),
    ],
)
def test_addresses_that_are_none(url: str) -> None:
    with pytest.raises(InputError, match=r"\$\.url"):
        TargetRules().parse(url)


async def test_a_name_is_looked_up_once_and_that_address_is_asked(folder: DataFolder) -> None:
    """DNS rebinding: the second answer leads elsewhere, where a second receiver waits in vain."""
    looked_up = []

    async def rebinding(host: str, port: int) -> Sequence[str]:
        looked_up.append((host, port))
        return ["127.0.0.1"] if len(looked_up) == 1 else ["127.0.0.2"]

    with Receiver() as receiver:
        name = f"http://rebinding.example:{receiver.server_port}/x"
        folder.webhooks.create("", name)
        make_render(folder, "r-1")
        end(folder, "r-1", "SUCCEEDED")
        async with sending(folder, TargetRules([HOME], rebinding)):
            await until(receiver, 1)
    assert looked_up == [("rebinding.example", receiver.server_port)]
    assert receiver.got[0][1]["Host"] == f"rebinding.example:{receiver.server_port}"


async def test_a_name_that_turns_private_is_not_asked(folder: DataFolder) -> None:
    async def private(*_: object) -> Sequence[str]:
        return ["127.0.0.1"]

    with Receiver() as receiver:
        folder.webhooks.create("", f"https://rebinding.example:{receiver.server_port}/x")
        make_render(folder, "r-1")
        end(folder, "r-1", "SUCCEEDED")
        async with sending(folder, TargetRules(resolve=private), ()):
            await until_true(lambda: bool(folder.webhooks.list("")[0].last_outcome))
    assert folder.webhooks.list("")[0].last_outcome == "rebinding.example is not a public address; given up"
    assert receiver.got == []


@pytest.mark.parametrize("name", ["hook.example", "other.example"])
async def test_the_certificate_is_that_of_the_name(folder: DataFolder, name: str) -> None:
    """Connected to by address, checked by name; one of another name is not talked to."""
    authority = trustme.CA()
    server = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    authority.issue_cert("hook.example").configure_cert(server)
    client = ssl.create_default_context()
    authority.configure_trust(client)

    async def at_home(*_: object) -> Sequence[str]:
        return ["127.0.0.1"]

    with Receiver(server) as receiver:
        folder.webhooks.create("", f"https://{name}:{receiver.server_port}/x")
        make_render(folder, "r-1")
        end(folder, "r-1", "SUCCEEDED")
        async with sending(folder, TargetRules([HOME], at_home), (), client):
            await until_true(lambda: bool(folder.webhooks.list("")[0].last_outcome))
    good = name == "hook.example"
    assert len(receiver.got) == (1 if good else 0)
    expected = "answered 204" if good else "no answer: ConnectError; given up"
    assert folder.webhooks.list("")[0].last_outcome == expected
