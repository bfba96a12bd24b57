"""Webhooks reach public addresses only, whatever names and certificates say."""

import ssl
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
import trustme
from nocturne_api.webhooks.targets import TargetRefused, TargetRules
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.errors import InputError

from tests.services.webhook_receiver import HOME, Receiver, end, make_render, sending, until, until_true


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[DataFolder]:
    folder = DataFolder(tmp_path / "data")
    yield folder
    folder.close()


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
    # The call that gives the address is refused at once.
    with pytest.raises(InputError, match=r"\$\.url.*not a public address"):
        rules.admit(f"https://{literal}/")
    rules.admit("https://name.example/")


@pytest.mark.parametrize("host", ["2130706433", "0x7f.1", "0177.0.0.1", "127.1", "localhost"])
async def test_other_spellings_of_this_machine_are_refused(host: str) -> None:
    """The check uses the addresses that the system's resolver returns for them."""
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
