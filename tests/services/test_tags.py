"""Tags, and searching renders by words."""

from typing import Any

import httpx
import pytest


async def made(rest: httpx.AsyncClient, body: dict[str, Any], name: str, **more: Any) -> str:
    answer = await rest.post("/v1/renders", json={**body, "request_id": name, "name": name, **more})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


async def found(rest: httpx.AsyncClient, **query: str) -> list[str]:
    answer = await rest.get("/v1/renders", params=query)
    assert answer.status_code == 200, answer.text
    return [each["name"] for each in answer.json()["renders"]]


async def test_renders_are_found_by_tags_and_words(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    lobby = await made(rest, body, "Lobby at night", tags=["night", "for review", "night"])
    await made(rest, body, "stairs", tags=["Für Anna"], group="house")
    assert (await rest.get(f"/v1/renders/{lobby}")).json()["tags"] == ["night", "for review"]
    assert await found(rest, tag="night") == ["Lobby at night"]
    # A tag is whole; words are parts.
    assert await found(rest, tag="nigh") == []
    assert await found(rest, search="NIGHT lobby") == ["Lobby at night"]
    assert await found(rest, search="review stairs") == []
    assert await found(rest, search="queued") == ["stairs", "Lobby at night"]
    assert await found(rest, search="house für") == ["stairs"]
    assert await found(rest, search="%") == []
    assert await found(rest, search=lobby[:7]) == ["Lobby at night"]


async def test_tags_are_changed(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    render_id = await made(rest, body, "a", tags=["old"])
    answer = await rest.post(f"/v1/renders/{render_id}:setTags", json={"tags": ["new", "x"]})
    assert answer.json()["tags"] == ["new", "x"]
    assert await found(rest, tag="new", search="a") == ["a"]
    answer = await rest.post(f"/v1/renders/{render_id}:setTags", json={"tags": []})
    assert answer.json()["tags"] == []


@pytest.mark.parametrize("tags", [[""], ["a,b"], ["a\n"], ["x" * 101], [str(i) for i in range(21)]])
async def test_a_tag_is_a_short_word(rest: httpx.AsyncClient, body: dict[str, Any], tags: list[str]) -> None:
    answer = await rest.post("/v1/renders", json={**body, "request_id": "a", "tags": tags})
    assert answer.status_code == 422
    assert answer.json()["problems"][0]["place"].startswith("$.tags")


@pytest.mark.parametrize("search", ["Österbro", "österbro", "ÖSTERBRO", "åben", "straße", "STRASSE"])
async def test_letters_of_any_alphabet_are_found_in_either_case(
    search: str, rest: httpx.AsyncClient, body: dict[str, Any]
) -> None:
    body |= {"name": "Österbro", "tags": ["Åben", "Straße"]}
    made = (await rest.post("/v1/renders", json=body)).json()
    found = (await rest.get("/v1/renders", params={"search": search})).json()["renders"]
    assert [each["id"] for each in found] == [made["id"]]
