"""Errors are sentences for whoever reads them: no path of the service's machine, no name of an exception."""

import asyncio
import hashlib
import logging
import re
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_api.service import Service
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.library_words import without_paths

Scene = dict[str, Any]

PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)


def mesh(file_format: str) -> Callable[[Scene, str], None]:
    def change(scene: Scene, asset: str) -> None:
        scene["surfaces"][0]["shape"] = {"type": "mesh", "asset": asset, "format": file_format}

    return change


def texture(scene: Scene, asset: str) -> None:
    scene["textures"] = {"paint": {"asset": asset}}
    scene["surfaces"][0]["kernel"] = {"type": "lambertian", "reflectance": {"texture": "paint"}}


def environment(scene: Scene, asset: str) -> None:
    scene["environment"] = {"asset": asset}


def profile(scene: Scene, asset: str) -> None:
    scene["surfaces"][1]["luminaire"]["profile"] = {"asset": asset}


def grid(scene: Scene, asset: str) -> None:
    scene["media"] = {"smoke": {"scattering": 1, "density": {"asset": asset, "grid": "density"}}}
    scene["unbounded_media"] = ["smoke"]


def measured(scene: Scene, asset: str) -> None:
    scene["surfaces"][0]["kernel"] = {"type": "measured", "asset": asset, "format": "merl"}


PNG = b"\x89PNG\r\n\x1a\n"
PICTURES = (
    b"no picture",
    PNG,
    PNG + b"\0\0\0\rIHDR" + struct.pack(">IIBBBBB", 10, 10, 8, 2, 0, 0, 0) + b"abcd",
    b"v/1\x01\x02\x00\x00\x00" + bytes(50),
    b"#?RADIANCE\n\n-Y 2 +X 2\n",
    b"\xff\xd8\xff\xe0\x00\x10JFIF",
)
HOSTILE: list[tuple[str, Callable[[Scene, str], None], bytes]] = [
    *(("texture", texture, each) for each in PICTURES),
    *(("environment", environment, each) for each in PICTURES),
    *(
        ("ply", mesh("ply"), PLY.replace(*change))
        for change in [
            (b"format ascii 1.0\n", b""),
            (b"ascii", b"binary_little_endian"),
            (b"float x", b"quux x"),
            (b"float x", b"float q"),
            (b"element vertex 3\n", b""),
            (b"property list uchar int vertex_indices", b"property int a"),
            (b"property list uchar int vertex_indices\n", b""),
            (b"1 0 0", b"a b c"),
            (b"3 0 1 2", b"3 0 1 9"),
            (b"3 0 1 2", b"3 0 1"),
        ]
    ),
    ("ply", mesh("ply"), b"ply\nend_header\n"),
    ("obj", mesh("obj"), b"v 0 0 0\nv 1 0 0\nf 1 2 9\n"),
    ("stl", mesh("stl"), b"solid a\n facet normal 0 0\n outer loop\n vertex 0 0 x\n"),
    ("glb", mesh("glb"), b"glTF\x02\x00\x00\x00\x20\x00\x00\x00\x04\x00\x00\x00JSON{}  "),
    ("ies", profile, b"IESNA:LM-63-2002\nTILT=/etc/passwd\n1 2 3\n"),
    ("grid", grid, b" BDV" + bytes(99)),
    ("grid", grid, b"no grid"),
    ("measured", measured, b"no table"),
]


@pytest.mark.parametrize(("kind", "change", "content"), HOSTILE, ids=[f"{kind}" for kind, *_ in HOSTILE])
async def test_a_file_that_is_none_is_told_in_a_sentence(
    kind: str,
    change: Callable[[Scene, str], None],
    content: bytes,
    body: dict[str, Any],
    rest: httpx.AsyncClient,
    tmp_path: Path,
) -> None:
    digest = hashlib.sha256(content).hexdigest()
    assert (await rest.put(f"/v1/assets/{digest}", content=content)).status_code == 200
    change(body["scene"], f"sha256:{digest}")
    answer = await rest.post("/v1/renders", json=body)
    assert answer.status_code == 422, (kind, answer.text)
    said = answer.json()["detail"]
    # About the file, not about the document around it.
    assert re.match(r"\$\.[\w.\[\]]+(asset|texture|profile|density)[\w.]*: ", said), said
    assert str(tmp_path) not in answer.text
    assert tempfile.gettempdir() not in answer.text
    assert digest not in said
    assert not re.search(r"\b[A-Z]\w*(Error|Exception)\b|Traceback", said), said


@pytest.mark.parametrize("content", PICTURES)
async def test_pictures_for_the_page_too(content: bytes, rest: httpx.AsyncClient) -> None:
    answer = await rest.post("/v1/pictures", content=content)
    assert answer.status_code == 422
    assert not re.search(r"/\w+/|picture\.exr", answer.json()["detail"]), answer.text


@pytest.mark.parametrize(
    ("said", "left"),
    [
        ('can\'t read "/srv/data/blobs/ab/abc": no PNG', "can't read the file: no PNG"),
        ("EXR Error (/tmp/x-1/a.exr): no magic\n number", "EXR Error the file: no magic number"),
        ("/a/b: not an OpenVDB file", "the file: not an OpenVDB file"),
        ("IoError: not a VDB file", "not a VDB file"),
        ("2 m/s, and/or 1/2", "2 m/s, and/or 1/2"),
        ("x" * 300, "x" * 197 + "..."),
    ],
)
def test_paths_are_left_out(said: str, left: str) -> None:
    assert without_paths(said) == left


@pytest.mark.parametrize(
    ("method", "path"), [("PUT", f"/v1/assets/{'a' * 64}"), ("POST", "/v1/renders"), ("POST", "/v1/pictures")]
)
async def test_a_broken_off_request_is_a_sentence_in_the_log(
    method: str, path: str, service: Service, folder: DataFolder, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO):
        _, writer = await asyncio.open_connection("127.0.0.1", service.port)
        head = f"{method} {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\n"
        writer.write(head.encode() + b"x" * 1000)
        await writer.drain()
        await asyncio.sleep(0.3)
        writer.close()
        await writer.wait_closed()
        for _ in range(1000):
            if "broken off" in caplog.text:
                break
            await asyncio.sleep(0.05)
        await asyncio.sleep(0.2)
    assert f"a request to {path} was broken off by its caller" in caplog.text
    assert "Traceback" not in caplog.text
    assert [record for record in caplog.records if record.levelno > logging.INFO] == []
    if method == "PUT":
        assert folder.calls.last(1)[0]["outcome"] == "BROKEN_OFF"
