"""The Python client and the command line against a real API."""

import asyncio
import copy
import json
import re
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_api.models import examples
from nocturne_api.service import Service
from nocturne_client import Client, NocturneClientError, NotReachedError, Render
from nocturne_client.cli.app import app
from nocturne_client.cli.output import ExitStatus
from nocturne_client.scene_files import read_scene
from nocturne_coordinator.store.data_folder import DataFolder
from typer.testing import CliRunner, Result

from tests.services import coordinator_acts


def _stl() -> bytes:
    """One triangle as binary STL."""
    triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    return b"\0" * 80 + struct.pack("<I", 1) + triangle


@pytest.fixture
def scene_path(scene: dict[str, Any], tmp_path: Path) -> Path:
    """A scene on disk with a mesh in a file next to it."""
    folder = tmp_path / "scene"
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "floor.stl").write_bytes(_stl())
    scene["surfaces"][0]["shape"] = {"type": "mesh", "asset": "meshes/floor.stl"}
    path = folder / "lamp.json"
    path.write_text(json.dumps(scene))
    return path


@pytest.fixture
def url(service: Service) -> str:
    return f"http://127.0.0.1:{service.port}"


async def test_submit_uploads_what_is_missing(url: str, scene_path: Path) -> None:
    uploaded: list[tuple[str, int, int]] = []

    def submit() -> list[Render]:
        with Client(url) as client:
            return [
                client.submit(
                    scene_path,
                    40,
                    30,
                    16,
                    request_id=f"r{n}",
                    progress=lambda p, n, of: uploaded.append((p.name, n, of)),
                )
                for n in range(2)
            ]

    first, second = await asyncio.to_thread(submit)
    assert uploaded == [("floor.stl", 134, 134)]
    assert first.name == "one lamp"
    assert first.scene_sha256 == second.scene_sha256
    assert first.id != second.id


async def test_get_list_cancel_download(
    url: str, scene_path: Path, folder: DataFolder, tmp_path: Path
) -> None:
    def use() -> None:
        with Client(url) as client:
            render = client.submit(scene_path, 40, 30, 16)
            assert client.get(render.id) == render
            assert list(client.list()) == [render]
            target = tmp_path / "out.png"
            target.write_bytes(b"before")
            with pytest.raises(NocturneClientError, match="no preview yet") as caught:
                client.download(render.id, "png", target)
            assert caught.value.status == 404
            assert target.read_bytes() == b"before"
            coordinator_acts.picture(folder, render.id, b"after")
            assert client.download(render.id, "png", target).read_bytes() == b"after"
            assert client.cancel(render.id).state == "CANCELLED"
            assert [state.state for state in client.watch(render.id)] == ["CANCELLED"]

    await asyncio.to_thread(use)


async def test_watch_to_the_end(url: str, scene_path: Path, folder: DataFolder) -> None:
    def use() -> list[float]:
        with Client(url) as client:
            seen = []
            for state in client.watch(client.submit(scene_path, 40, 30, 16).id):
                seen.append(state.fraction)
                if len(seen) == 1:
                    coordinator_acts.progress(folder, state.id, 40 * 30 * 8)
                else:
                    coordinator_acts.finish(folder, state.id)
            return seen

    assert await asyncio.to_thread(use) == [0.0, 0.5, 0.5]


def test_watch_connects_again_and_asks_for_later_states_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("nocturne_client.transport.RETRY_DELAYS_S", (0.0, 0.0))
    asked: list[str | None] = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request.headers.get("last-event-id"))
        if len(asked) == 2:
            raise httpx.ReadError("connection lost")
        state = "RUNNING" if len(asked) == 1 else "SUCCEEDED"
        return _event(_render(state, len(asked)))

    with Client("http://test", transport=httpx.MockTransport(answer)) as client:
        assert [state.state for state in client.watch("r")] == ["RUNNING", "SUCCEEDED"]
    assert asked == [None, "1", "1"]


def test_watch_outlives_a_service_that_is_started_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many refusals as a start takes, and more than other calls are tried."""
    monkeypatch.setattr("nocturne_client.client._WATCH_DELAYS_S", (0.0,) * 9)
    made = 0

    def answer(_: httpx.Request) -> httpx.Response:
        nonlocal made
        made += 1
        if 1 < made < 10:
            raise httpx.ConnectError("refused")
        return _event(_render("RUNNING" if made == 1 else "SUCCEEDED", made))

    with Client("http://test", transport=httpx.MockTransport(answer)) as client:
        assert [state.state for state in client.watch("r")] == ["RUNNING", "SUCCEEDED"]
    assert made == 10


def test_a_sentence_may_have_what_other_texts_end_lines_with() -> None:
    """Lines of events end at LF and CR alone; a worker's words may have other separators."""
    reason = "Tile 3:\x0c\u0085\u2028no memory"

    def answer(_: httpx.Request) -> httpx.Response:
        return _event({**_render("FAILED", 1), "reason": reason})

    with Client("http://test", transport=httpx.MockTransport(answer)) as client:
        assert [state.reason for state in client.watch("r")] == [reason]


def test_a_missing_token_is_told_in_words_of_the_command_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NOCTURNE_TOKEN", raising=False)

    def answer(_: httpx.Request) -> httpx.Response:
        return httpx.Response(401, json={"detail": "a token is needed: `Authorization: Bearer TOKEN`"})

    for token, words in ((None, "set NOCTURNE_TOKEN to one"), ("nct_x", "does not know this token")):
        transport = httpx.MockTransport(answer)
        with (
            Client("http://test", transport=transport, token=token) as client,
            pytest.raises(NocturneClientError, match=words),
        ):
            client.list()


@pytest.mark.parametrize(
    ("status", "retry_after", "waited"),
    [
        (503, "", [0.0, 0.5]),
        (503, "60", [60.0, 60.0, 60.0]),
        # A quota that is used up.
        (429, "60", [60.0, 60.0, 60.0]),
        (429, "100", [100.0]),
        (429, "200", []),
        (503, "Wed, 21 Oct 2026 07:28:00 GMT", [0.0, 0.5]),
        *((status, "1", []) for status in (500, 404, 422, 507)),
    ],
)
def test_what_is_busy_is_asked_again_when_it_says(
    status: int, retry_after: str, waited: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    slept: list[float] = []
    told: list[float] = []
    monkeypatch.setattr("nocturne_client.transport.RETRY_DELAYS_S", (0.0, 0.5))
    monkeypatch.setattr("nocturne_client.transport.time.sleep", slept.append)
    made = 0

    def answer(_: httpx.Request) -> httpx.Response:
        nonlocal made
        made += 1
        headers = {"Retry-After": retry_after} if retry_after else {}
        return httpx.Response(status, json={"detail": "no", "problems": []}, headers=headers)

    with (
        Client(
            "http://test",
            transport=httpx.MockTransport(answer),
            on_wait=lambda _, seconds: told.append(seconds),
        ) as client,
        pytest.raises(NocturneClientError) as caught,
    ):
        client.get("r")
    assert (made, slept) == (1 + len(waited), waited)
    assert told == [each for each in waited if retry_after.isdecimal()]
    assert caught.value.can_be_retried == (status in (429, 503))


class _BreaksOff(httpx.SyncByteStream):
    def __init__(self, content: bytes) -> None:
        self._content = content

    def __iter__(self) -> Iterator[bytes]:
        yield self._content
        raise httpx.ReadError("the connection was lost")


@pytest.mark.parametrize("is_another", [False, True])
def test_a_download_that_broke_off_goes_on(
    is_another: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the file is another one by now, from its beginning."""
    monkeypatch.setattr("nocturne_client.transport.RETRY_DELAYS_S", (0.0, 0.0))
    before, now = b"0123456789" * 1000, b"abc" * 5 if is_another else b"0123456789" * 1000
    asked: list[tuple[str | None, str | None]] = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append((request.headers.get("range"), request.headers.get("if-range")))
        first = asked[-1][0]
        if first is None:
            return httpx.Response(200, stream=_BreaksOff(before[:1000]), headers={"ETag": '"a"'})
        if is_another:
            return httpx.Response(200, content=now, headers={"ETag": '"b"'})
        end = 5000 if first == "bytes=1000-" else len(now)
        rest = now[int(first[6:-1]) : end]
        broken = httpx.Response(206, stream=_BreaksOff(rest), headers={"ETag": '"a"'})
        return broken if end == 5000 else httpx.Response(206, content=rest, headers={"ETag": '"a"'})

    with Client("http://test", transport=httpx.MockTransport(answer)) as client:
        assert client.download("r", "exr", tmp_path / "image.exr").read_bytes() == now
    parts = ["bytes=1000-"] if is_another else ["bytes=1000-", "bytes=5000-"]
    assert asked == [(None, None), *((part, '"a"') for part in parts)]


def test_ids_stay_one_part_of_the_path() -> None:
    asked: list[bytes] = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request.url.raw_path)
        return httpx.Response(404)

    with Client("http://test", transport=httpx.MockTransport(answer)) as client:
        for render_id in ("../workers", "a?b#c", "ä/ö"):
            with pytest.raises(NocturneClientError):
                client.get(render_id)
    assert asked == [b"/v1/renders/..%2Fworkers", b"/v1/renders/a%3Fb%23c", b"/v1/renders/%C3%A4%2F%C3%B6"]


@pytest.mark.parametrize(
    "asset", ["../secret.ply", "/etc/passwd", "missing.ply", "link.ply", "meshes", "a/../../b.ply"]
)
def test_asset_paths_stay_in_the_scene_folder(asset: str, scene: dict[str, Any], tmp_path: Path) -> None:
    folder = tmp_path / "scene"
    (folder / "meshes").mkdir(parents=True)
    (tmp_path / "secret.ply").write_text("secret")
    (folder / "link.ply").symlink_to(tmp_path / "secret.ply")
    scene["surfaces"][0]["shape"] = {"type": "mesh", "asset": asset}
    (folder / "scene.json").write_text(json.dumps(scene))
    with pytest.raises(NocturneClientError) as caught:
        read_scene(folder / "scene.json")
    assert [problem.place for problem in caught.value.problems] == ["$.surfaces[0].shape.asset"]


def test_every_file_of_a_scene_is_named_by_digest(scene: dict[str, Any], tmp_path: Path) -> None:
    names = ("sky.exr", "wood.png", "lamp.ies", "paint.binary", "a.ply")
    for name in names:
        (tmp_path / name).write_text(name)
    scene["environment"] = {"asset": "sky.exr"}
    scene["textures"] = {"wood": {"asset": "wood.png"}}
    scene["surfaces"][0]["shape"] = {"type": "mesh", "asset": "a.ply"}
    scene["surfaces"][0]["kernel"] = {"type": "measured", "asset": "paint.binary", "format": "merl"}
    scene["surfaces"][0]["luminaire"] = {"radiance": 1, "profile": {"asset": "lamp.ies"}}
    scene["sensor"]["responses"] = {"asset": "white"}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    found = read_scene(tmp_path / "scene.json")
    assert {path.name for path in found.files.values()} == set(names)
    assert found.document["environment"]["asset"].startswith("sha256:")
    assert found.document["surfaces"][0]["shape"]["format"] == "ply"
    assert "format" not in found.document["environment"]
    assert found.document["sensor"]["responses"] == {"asset": "white"}


def test_a_scene_without_its_files_says_which_program_makes_them(
    scene: dict[str, Any], tmp_path: Path
) -> None:
    scene["environment"] = {"asset": "sky.exr"}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    with pytest.raises(NocturneClientError, match=r"files are missing$"):
        read_scene(tmp_path / "scene.json")
    (tmp_path / "make_sky.py").touch()
    for missing in ("scene.json", "forest.json"):
        with pytest.raises(NocturneClientError, match=rf"{missing}: .*make_sky\.py`$"):
            read_scene(tmp_path / missing)


@pytest.mark.parametrize("text", ["", "{", "[]", "[" * 100_000])
def test_documents_that_are_no_scene(text: str, tmp_path: Path) -> None:
    (tmp_path / "scene.json").write_text(text)
    with pytest.raises(NocturneClientError, match=r"scene\.json"):
        read_scene(tmp_path / "scene.json")


@pytest.fixture
def run(url: str) -> Callable[..., Result]:
    """The command line in this process, asking this service."""

    def invoke(*arguments: str) -> Result:
        return CliRunner().invoke(app, list(arguments), env={"NOCTURNE_URL": url})

    return invoke


async def test_command_line(
    run: Callable[..., Result], scene_path: Path, folder: DataFolder, tmp_path: Path
) -> None:
    def use() -> None:
        submitted = run("submit", str(scene_path), "--width", "40", "--height", "30", "--samples", "16")
        assert submitted.exit_code == 0, submitted.output
        render_id = submitted.stdout.strip()
        assert json.loads(run("get", render_id, "--json").stdout)["samples"] == 16
        assert render_id in run("list").stdout
        assert render_id in run("top", "--once").stdout
        kept = run("delete", render_id)
        assert "is QUEUED, 0% done. Cancel and delete it?" in kept.output
        assert kept.exit_code == 1
        assert json.loads(run("get", render_id, "--json").stdout)["state"] == "QUEUED"
        coordinator_acts.picture(folder, render_id, b"png")
        assert run("get", render_id, "--png", str(tmp_path / "a.png")).exit_code == 0
        assert (tmp_path / "a.png").read_bytes() == b"png"
        coordinator_acts.finish(folder, render_id)
        assert run("watch", render_id).exit_code == 0
        states = [json.loads(line)["state"] for line in run("watch", render_id, "--json").stdout.splitlines()]
        assert states == ["SUCCEEDED"]
        failed = run("watch", "none")
        assert isinstance(failed.exception, NocturneClientError)

    await asyncio.to_thread(use)


def test_who_submits_in_vain_is_told_how_to_get_the_render(scene_path: Path) -> None:
    """Perhaps only the answer was lost."""
    tried = CliRunner().invoke(app, ["submit", str(scene_path), "--url", "http://127.0.0.1:9"])
    assert isinstance(tried.exception, NotReachedError)
    assert re.search(r"again with --request-id [\w-]{36}", tried.output)


def test_no_service_there_is_a_clear_error() -> None:
    with Client("http://127.0.0.1:9") as client, pytest.raises(NotReachedError, match="nocturne up"):
        client.workers()


def test_exit_statuses_are_what_the_help_says() -> None:
    text = " ".join(CliRunner().invoke(app, ["--help"]).output.split())
    for status in (ExitStatus.FAILED, ExitStatus.WRONG, ExitStatus.NOT_REACHED, ExitStatus.INTERRUPTED):
        assert f"{int(status)} " in text


def _render(state: str, sequence: int) -> dict[str, Any]:
    return {**copy.deepcopy(examples.RENDER), "state": state, "sequence": sequence}


def _event(render: dict[str, Any]) -> httpx.Response:
    text = f"event: render\ndata: {json.dumps(render, ensure_ascii=False)}\nid: {render['sequence']}\n\n"
    return httpx.Response(200, text=text, headers={"Content-Type": "text/event-stream"})
