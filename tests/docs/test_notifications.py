"""The receiver that docs/how-to/notifications.md shows, between the real sender and a mail server."""

import asyncio
import email
import ipaddress
import json
import re
import socket
import socketserver
import subprocess
import sys
import threading
from collections.abc import Iterator
from email.message import Message
from pathlib import Path

import httpx
import pytest
from nocturne_api.webhooks.targets import TargetRules
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services.webhook_receiver import end, make_render, sending, until_true

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "notifications.md"
HOME = ipaddress.ip_network("127.0.0.1/32")


class MailServer(socketserver.TCPServer):
    """Takes mails as RFC 5321 has it, without any extension; refuses the first `refused` of them."""

    allow_reuse_address = True

    def __init__(self, refused: int) -> None:
        super().__init__(("127.0.0.1", 0), _Mail)
        self.mails: list[Message] = []
        self.refused = refused


class _Mail(socketserver.StreamRequestHandler):
    def handle(self) -> None:
        server = self.server
        assert isinstance(server, MailServer)
        self.wfile.write(b"220 ready\r\n")
        for line in iter(self.rfile.readline, b""):
            word = line.split()[0].upper()
            if word != b"DATA":
                self.wfile.write(b"221 bye\r\n" if word == b"QUIT" else b"250 ok\r\n")
                continue
            if server.refused:
                server.refused -= 1
                self.wfile.write(b"451 later\r\n")
                continue
            self.wfile.write(b"354 go on\r\n")
            lines = iter(self.rfile.readline, b".\r\n")
            server.mails.append(email.message_from_bytes(b"".join(lines)))
            self.wfile.write(b"250 taken\r\n")


@pytest.fixture
def mail_server() -> Iterator[MailServer]:
    with MailServer(refused=1) as server:
        threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()
        yield server
        server.shutdown()


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def answers(port: int) -> bool:
    with socket.socket() as caller:
        return caller.connect_ex(("127.0.0.1", port)) == 0


async def test_the_receiver_sends_a_mail_for_each_signed_message(
    tmp_path: Path, mail_server: MailServer
) -> None:
    text = PAGE.read_text()
    (program,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (shown,) = re.findall(r"```json\n(.*?)```", text, re.DOTALL)
    (tmp_path / "mail.py").write_text(program)
    folder = DataFolder(tmp_path / "data")
    listen = free_port()
    _, secret = folder.webhooks.create("", f"http://127.0.0.1:{listen}/")
    settings = json.loads(shown) | {"secret": secret, "listen": listen}
    settings |= {"host": "127.0.0.1", "port": mail_server.server_address[1]}
    # Passwords go over TLS only; a relay at home asks for none.
    del settings["user"], settings["password"]
    (tmp_path / "mail.json").write_text(json.dumps(settings))
    command = [sys.executable, str(tmp_path / "mail.py"), str(tmp_path / "mail.json")]
    receiver = await asyncio.create_subprocess_exec(*command, stderr=subprocess.DEVNULL)
    try:
        await until_true(lambda: answers(listen))
        make_render(folder, "r-1")
        end(folder, "r-1", "DEGRADED", "One tile failed.")
        async with sending(folder, TargetRules([HOME])):
            await until_true(lambda: len(mail_server.mails) == 1)
        async with httpx.AsyncClient() as stranger:
            unsigned = await stranger.post(f"http://127.0.0.1:{listen}/", content=b"{}")
    finally:
        receiver.kill()
        await receiver.wait()
        folder.close()
    (mail,) = mail_server.mails
    assert mail_server.refused == 0
    assert (mail["Subject"], mail["To"]) == ("Nocturne: night: degraded", "you@example.org")
    assert mail.get_payload() == "One tile failed.\r\nhttp://127.0.0.1:7070/#/renders/r-1\r\n"
    assert unsigned.status_code == 401
