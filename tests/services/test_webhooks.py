"""Webhooks: real receivers, signatures checked by the specification's own library, and nowhere private."""

import asyncio
import logging
import socket
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
from nocturne_api.service import Service, Settings
from nocturne_api.webhooks.sender import PAUSES_S
from nocturne_api.webhooks.targets import TargetRules
from nocturne_coordinator.store.data_folder import DataFolder
from standardwebhooks import Webhook, WebhookVerificationError

from tests.services.endpoints import rest_client, started
from tests.services.webhook_receiver import HOME, Receiver, end, make_render, sending, until, until_true


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[DataFolder]:
    folder = DataFolder(tmp_path / "data")
    yield folder
    folder.close()


@pytest.fixture
async def service(folder: DataFolder) -> AsyncIterator[Service]:
    settings = Settings(data=folder.root, web=folder.root, port=0, grpc_port=0, webhook_networks=[HOME])
    async with started(settings) as service:
        yield service


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
        "data": {
            "id": "r-DEGRADED",
            "name": "night",
            "state": "DEGRADED",
            "reason": "because",
            "error_warning": "",
        },
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


async def test_a_miss_is_told_before_the_end(folder: DataFolder) -> None:
    with Receiver() as receiver:
        _, secret = folder.webhooks.create("", receiver.url)
        make_render(folder, "r-1")
        for sentence in ("It will miss.", "", "It will miss again."):
            folder.database.execute("UPDATE render SET target_unreachable = ? WHERE id = 'r-1'", (sentence,))
        async with sending(folder, TargetRules([HOME])):
            await until(receiver, 1)
    ((_, headers, body),) = receiver.got
    message = Webhook(secret).verify(body, headers)
    assert message["type"] == "render.target_unreachable"
    assert (message["data"]["state"], message["data"]["reason"]) == ("RUNNING", "It will miss.")


async def test_webhooks_are_made_listed_and_deleted(service: Service) -> None:
    async with rest_client(service) as rest:
        made = (await rest.post("/v1/webhooks", json={"url": "https://example.org/x"})).json()
        assert made.pop("secret").startswith("whsec_")
        assert (await rest.get("/v1/webhooks")).json()["webhooks"] == [made]
        assert (await rest.delete(f"/v1/webhooks/{made['id']}")).status_code == 204
        assert (await rest.delete(f"/v1/webhooks/{made['id']}")).status_code == 404
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
    assert folder.webhooks.take_due(2e12, 1.0, 9, 9) == []


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


async def test_dead_addresses_of_one_owner_delay_nobody_else(folder: DataFolder) -> None:
    """Twenty that accept and never answer, with three messages each, all of them due before the other's."""
    with socket.create_server(("127.0.0.1", 0), backlog=1000) as hole, Receiver() as receiver:
        address = f"http://127.0.0.1:{hole.getsockname()[1]}/"
        for _ in range(20):
            folder.webhooks.create("alice", address)
        folder.webhooks.create("bob", receiver.url)
        for number in range(3):
            make_render(folder, f"r-{number}", "alice")
            end(folder, f"r-{number}", "SUCCEEDED")
        async with sending(folder, TargetRules([HOME])):
            await asyncio.sleep(0.5)
            make_render(folder, "r-bob", "bob")
            end(folder, "r-bob", "SUCCEEDED")
            begun = time.monotonic()
            await until(receiver, 1)
            # A look a second, where one attempt at a dead address takes fifteen.
            assert time.monotonic() - begun < 3.0


def test_messages_are_taken_in_bounds(folder: DataFolder) -> None:
    """One of each webhook, some of each owner; the rest when those are over."""
    for owner, hooks in (("alice", 6), ("bob", 1)):
        for _ in range(hooks):
            folder.webhooks.create(owner, "https://example.org/")
        for number in range(2):
            make_render(folder, f"r-{owner}-{number}", owner)
            end(folder, f"r-{owner}-{number}", "SUCCEEDED")
    taken = folder.webhooks.take_due(2e12, 1.0, 5, 3)
    assert sorted(message.owner for message in taken) == ["alice"] * 3 + ["bob"]
    assert len({message.webhook_id for message in taken}) == 4
    further = folder.webhooks.take_due(2e12, 1.0, 5, 4, taken)
    assert [message.owner for message in further] == ["alice"]
    assert {message.webhook_id for message in further}.isdisjoint(each.webhook_id for each in taken)
