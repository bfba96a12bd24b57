"""pbrt's text from any system: what its tokenizer takes (parser.cpp of pbrt-v4), and what editors add."""

import codecs
import gzip
import json
from pathlib import Path
from typing import Any

import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

SCENE = """# A comment
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [1 1 1] "float scale" 100
Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
Shape "sphere" "float radius" 2
"""


def imported(tmp_path: Path, content: bytes, name: str = "a.pbrt") -> dict[str, Any]:
    (tmp_path / "in").mkdir(exist_ok=True)
    (tmp_path / "in" / name).write_bytes(content)
    found = import_scene(tmp_path / "in" / name, tmp_path / "out", ImportOptions())
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document


# https://github.com/ISET/iset3d-v3/issues/44 and https://github.com/DavidBrainard/RenderToolbox3/issues/15:
# scene text from other systems.
@pytest.mark.parametrize(
    "content",
    [
        SCENE.replace('"float radius"', '"float\tradius"').encode(),
        SCENE.replace('"float radius"', '"  float \t radius\t"').encode(),
        SCENE.replace("A comment", "Büro").encode("latin-1"),
        SCENE.replace("A comment", "Büro").encode(),
        SCENE.replace("\n", "\r\n").encode(),
        SCENE.replace("\n", "\r").encode(),
        codecs.BOM_UTF8 + SCENE.encode(),
        SCENE.encode("utf-16"),
        codecs.BOM_UTF16_BE + SCENE.encode("utf-16-be"),
    ],
)
@pytest.mark.parametrize("compressed", [False, True])
def test_text_of_other_systems(tmp_path: Path, content: bytes, compressed: bool) -> None:
    name = "a.pbrt.gz" if compressed else "a.pbrt"
    document = imported(tmp_path, gzip.compress(content) if compressed else content, name)
    assert document["environment"]["radiance"]["luminance"] == 100
    assert document["surfaces"][0]["shape"]["radius"] == 2


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_names_with_letters_beyond_ascii(tmp_path: Path, encoding: str) -> None:
    """A file whose name is in UTF-8, as systems of today have them, whatever the scene's text is in."""
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "Möbel.pbrt").write_text('Shape "sphere" "float radius" 3\n')
    document = imported(tmp_path, (SCENE + 'Include "Möbel.pbrt"\n').encode(encoding))
    assert [surface["shape"]["radius"] for surface in document["surfaces"]] == [2, 3]


def test_names_in_capitals(tmp_path: Path) -> None:
    """As Windows finds them; the same letters first."""
    (tmp_path / "in" / "Parts").mkdir(parents=True)
    (tmp_path / "in" / "Parts" / "new.PBRT").write_text('Shape "sphere" "float radius" 3\n')
    (tmp_path / "in" / "same.pbrt").write_text('Shape "sphere" "float radius" 4\n')
    (tmp_path / "in" / "Same.pbrt").write_text('Shape "sphere" "float radius" 5\n')
    body = 'Include "parts\\NEW.pbrt"\nInclude "same.pbrt"\nInclude "parts/../Same.pbrt"\n'
    document = imported(tmp_path, (SCENE + body).encode())
    assert [surface["shape"]["radius"] for surface in document["surfaces"]] == [2, 3, 4, 5]


def test_names_in_capitals_stay_below_the_root(tmp_path: Path) -> None:
    (tmp_path / "b.pbrt").write_text("")
    with pytest.raises(InputError, match="leads out of"):
        imported(tmp_path, (SCENE + 'Include "../B.pbrt"').encode())


def test_quotes_and_backslashes_in_strings(tmp_path: Path) -> None:
    """pbrt's escapes; a single backslash is one of a path of Windows."""
    (tmp_path / "in" / "parts").mkdir(parents=True)
    (tmp_path / "in" / "parts" / "new.pbrt").write_text('Shape "sphere" "float radius" 3\n')
    body = r"""
    MakeNamedMaterial "the \"red\" one" "string type" "diffuse"
    NamedMaterial "the \"red\" one"
    Include "parts\\new.pbrt"
    Include "parts\new.pbrt"
    """
    document = imported(tmp_path, (SCENE + body).encode())
    assert [surface["shape"]["radius"] for surface in document["surfaces"]] == [2, 3, 3]


@pytest.mark.parametrize("word", ["true", "True", "TRUE", '"true"', '"True"', "[ True ]"])
def test_booleans_in_letters_of_either_case(tmp_path: Path, word: str) -> None:
    body = f'AreaLightSource "diffuse" "bool twosided" {word} Shape "sphere"\n'
    [_, lamp] = imported(tmp_path, (SCENE + body).encode())["surfaces"]
    assert lamp["luminaire"]["two_sided"]


@pytest.mark.parametrize("name", ["srgb", "sRGB", "SRGB"])
def test_colour_spaces_in_letters_of_either_case(tmp_path: Path, name: str) -> None:
    """RGBColorSpace::GetNamed."""
    assert imported(tmp_path, (SCENE + f'ColorSpace "{name}"\n').encode())["surfaces"]


def test_other_colour_spaces_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='no support for the colour space "rec2020"'):
        imported(tmp_path, (SCENE + 'ColorSpace "rec2020"\n').encode())


def test_no_other_word_is_a_boolean(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a string"):
        imported(tmp_path, (SCENE + 'AreaLightSource "diffuse" "bool twosided" yes Shape "sphere"').encode())
