"""Mitsuba's files from any system and any program: what its parser takes (src/core/parser.cpp)."""

import codecs
import json
from pathlib import Path

import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

from tests.scene.formats.mitsuba_import import SENSOR, SPHERE, imported, kernel


@pytest.mark.parametrize(
    ("word", "flipped"),
    [("True", True), ("TRUE", True), ("true", True), (" true ", True), ("False", False), ("FALSE", False)],
)
def test_booleans_in_letters_of_either_case(tmp_path: Path, word: str, flipped: bool) -> None:
    """string::iequals; programs in Python write True."""
    body = f'<shape type="rectangle"><boolean name="flip_normals" value="{word}"/></shape>'
    plain, _ = imported(tmp_path / "a", body.replace(word, str(flipped).lower()))
    document, _ = imported(tmp_path / "b", body)
    assert document["surfaces"] == plain["surfaces"]


def test_no_other_word_is_a_boolean(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='expected true or false, found "1"'):
        imported(tmp_path, '<shape type="rectangle"><boolean name="flip_normals" value="1"/></shape>')


def test_whole_numbers_between_blanks(tmp_path: Path) -> None:
    document, _ = imported(
        tmp_path, f'<integrator type="path"><integer name="max_depth" value=" 3&#10;"/></integrator>{SPHERE}'
    )
    assert document["tracing"]["maximum_depth"] == 2


SCENE = f'<scene version="3.0.0">{SENSOR}<!-- Büro -->{SPHERE}<emitter type="constant"/></scene>'


@pytest.mark.parametrize(
    "content",
    [
        codecs.BOM_UTF8 + SCENE.encode(),
        SCENE.encode("latin-1"),
        ('<?xml version="1.0"?>' + SCENE).encode("latin-1"),
        ('<?xml version="1.0" encoding="utf-8"?>' + SCENE).encode("latin-1"),
        ('<?xml version="1.0" encoding="iso-8859-1"?>' + SCENE).encode("latin-1"),
        SCENE.encode("utf-16"),
        ('<?xml version="1.0" encoding="UTF-16"?>' + SCENE).encode("utf-16"),
        SCENE.replace("\n", "\r\n").encode(),
        SCENE.replace("\n", "\r").encode(),
    ],
)
def test_text_of_other_systems(tmp_path: Path, content: bytes) -> None:
    """A byte that is no UTF-8 is no reason to refuse a file, as it is none to Mitsuba."""
    (tmp_path / "a.xml").write_bytes(content)
    found = import_scene(tmp_path / "a.xml", tmp_path / "out", ImportOptions())
    assert len(json.loads(found.document.read_text())["surfaces"]) == 1


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("start", ["", "\ufeff", "# Grün\n"])
def test_spectra_in_text_files(tmp_path: Path, start: str, end: str) -> None:
    (tmp_path / "in").mkdir()
    text = start + "400 0.25\n700 0.5\n"
    (tmp_path / "in" / "a.spd").write_bytes(text.replace("\n", end).encode())
    bsdf = '<bsdf type="diffuse"><spectrum name="reflectance" filename="a.spd"/></bsdf>'
    assert "[400.0, 0.25]" in str(kernel(tmp_path, bsdf))
