"""The page's token: a cookie that scripts cannot read, taken from a header once."""

from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest
from nocturne_api.service import Settings
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services.endpoints import started

STRICT = {"httponly", "samesite=strict", "path=/v1"}


@pytest.fixture
async def guarded(tmp_path: Path, web: Path) -> AsyncIterator[tuple[httpx.AsyncClient, str]]:
    """A client of a service that asks for tokens, and a token that may read."""
    folder = DataFolder(tmp_path / "data")
    secret = folder.tokens.create("eve", ["read"])
    settings = Settings(data=tmp_path / "data", web=web, port=0, grpc_port=0, auth=True)
    async with started(settings) as service:
        address = f"http://127.0.0.1:{service.port}"
        async with httpx.AsyncClient(base_url=address, trust_env=False) as client:
            yield client, secret
    folder.close()


async def test_the_cookie_opens_what_the_header_opens(guarded: tuple[httpx.AsyncClient, str]) -> None:
    client, secret = guarded
    assert (await client.get("/")).status_code == 200
    assert (await client.get("/v1/renders")).status_code == 401
    begun = await client.post("/v1/session", headers={"Authorization": f"Bearer {secret}"})
    assert begun.json() == {"name": "eve", "scopes": ["read"]}
    cookie = begun.headers["set-cookie"].lower()
    assert {part.strip() for part in cookie.split(";")} >= STRICT
    assert (await client.get("/v1/renders")).status_code == 200
    assert (await client.get("/v1/session")).json()["name"] == "eve"
    assert (await client.post("/v1/renders/r-none:cancel", json={})).status_code in (403, 404)
    await client.delete("/v1/session")
    assert (await client.get("/v1/renders")).status_code == 401


async def test_a_revoked_token_takes_its_cookie_along(
    guarded: tuple[httpx.AsyncClient, str], tmp_path: Path
) -> None:
    client, secret = guarded
    await client.post("/v1/session", headers={"Authorization": f"Bearer {secret}"})
    folder = DataFolder(tmp_path / "data")
    folder.tokens.revoke("eve")
    folder.close()
    assert (await client.get("/v1/renders")).status_code == 401
    assert "nocturne_token" not in client.cookies


async def test_scripts_are_not_made_to_ask_for_a_password(guarded: tuple[httpx.AsyncClient, str]) -> None:
    """A browser shows its own dialog for Basic, also over a page that has a form for it."""
    client, _ = guarded
    script = await client.get("/v1/renders", headers={"Sec-Fetch-Dest": "empty"})
    person = await client.get("/v1/renders", headers={"Sec-Fetch-Dest": "document"})
    assert script.headers["www-authenticate"] == "Bearer"
    assert person.headers["www-authenticate"].startswith("Basic")


async def test_other_sites_cannot_use_the_cookie(guarded: tuple[httpx.AsyncClient, str]) -> None:
    client, secret = guarded
    await client.post("/v1/session", headers={"Authorization": f"Bearer {secret}"})
    answer = await client.delete("/v1/session", headers={"Origin": "https://elsewhere.example"})
    assert answer.status_code == 403


async def test_without_authentication_nobody_may_do_everything(rest: httpx.AsyncClient) -> None:
    answer = await rest.get("/v1/session")
    assert answer.json() == {"name": "", "scopes": ["admin", "read", "submit", "worker"]}


async def test_a_copied_cookie_is_no_token_and_ends_with_its_session(
    guarded: tuple[httpx.AsyncClient, str],
) -> None:
    client, secret = guarded
    await client.post("/v1/session", headers={"Authorization": f"Bearer {secret}"})
    copied = client.cookies["nocturne_token"]
    assert secret not in copied
    async with httpx.AsyncClient(base_url=client.base_url, trust_env=False) as thief:
        cookie = {"Cookie": f"nocturne_token={copied}"}
        assert (await thief.get("/v1/renders", headers=cookie)).status_code == 200
        as_token = await thief.get("/v1/renders", headers={"Authorization": f"Bearer {copied}"})
        assert as_token.status_code == 401
        raw = await thief.get("/v1/renders", headers={"Cookie": f"nocturne_token={secret}"})
        assert raw.status_code == 401
        await client.delete("/v1/session")
        assert (await thief.get("/v1/renders", headers=cookie)).status_code == 401


@pytest.mark.parametrize("behind_proxy", [False, True])
async def test_the_cookie_is_secure_behind_a_proxy_that_is_trusted(
    tmp_path: Path, web: Path, behind_proxy: bool
) -> None:
    folder = DataFolder(tmp_path / "data")
    secret = folder.tokens.create("eve", ["read"])
    folder.close()
    settings = Settings(
        data=tmp_path / "data", web=web, port=0, grpc_port=0, auth=True, behind_proxy=behind_proxy
    )
    async with (
        started(settings) as service,
        httpx.AsyncClient(base_url=f"http://127.0.0.1:{service.port}", trust_env=False) as client,
    ):
        for said in ("https", "http"):
            headers = {"Authorization": f"Bearer {secret}", "X-Forwarded-Proto": said}
            cookie = (await client.post("/v1/session", headers=headers)).headers["set-cookie"]
            assert ("secure" in cookie.lower()) is (behind_proxy and said == "https")
