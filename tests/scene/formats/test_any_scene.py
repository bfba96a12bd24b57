"""Arbitrarily damaged files give an import or one of Nocturne's errors, soon, and nothing is left behind.

The corpus has one file of each format that names most of what an importer knows. Words of it are changed,
left out, copied and swapped; of binary files, bytes.
"""

import re
import shutil
import tempfile
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.reading.options import ImportOptions

from tests.fuzzing import tried

CORPUS = Path(__file__).parent / "corpus"
# Of one import; a whole one takes less than one.
_SECONDS = 20

_QUIETLY = tried(examples=15)

_TOKEN = re.compile(rb"[A-Za-z_$]+|[-+0-9.eE]+|\s+|.", re.DOTALL)
WORDS = (
    *(b"", b"0", b"-0", b"-1", b"1e-320", b"1e30", b"1e308", b"1e400", b"nan", b"inf", b"0.5", b"2"),
    *(b"255", b"65536", b"2147483648", b"4294967295", b"99999999999999999999", b"1 1 1", b"x" * 5000),
    *(b"../a.ply", b"/etc/passwd", b"a.ply", b"a.vol", b"scene.xml", b"true", b"null", b"[]", b"{}", b"[ ]"),
    *(b'"', b"[", b"]", b"<", b">", b"&x;", b"#", b"\x00", b"\xff\xfe", "\N{SNOWMAN}".encode(), b"=", b","),
)
_CHANGE = st.tuples(
    st.sampled_from(("replace", "remove", "copy", "swap")),
    st.integers(0, 10_000),
    st.integers(0, 10_000),
    st.integers(1, 30),
    st.sampled_from(WORDS),
)
Change = tuple[str, int, int, int, bytes]
CHANGES = st.lists(_CHANGE, min_size=1, max_size=5)


def changed(content: bytes, changes: list[Change]) -> bytes:
    """The content with words replaced by others, or some of them removed, copied or swapped."""
    tokens = [token for token in _TOKEN.findall(content) if token]
    for act, at, other, count, word in changes:
        solid = [index for index, token in enumerate(tokens) if not token.isspace()]
        if not solid:
            break
        first, second = solid[at % len(solid)], solid[other % len(solid)]
        if act == "replace":
            tokens[first] = word
        elif act == "remove":
            del tokens[first : first + count]
        elif act == "copy":
            tokens[second:second] = tokens[first : first + count]
        else:
            tokens[first], tokens[second] = tokens[second], tokens[first]
    return b"".join(tokens)


def try_import(name: str, contents: dict[str, bytes], *, allow_missing: bool) -> None:
    """Import a scene among some files of a folder."""
    with tempfile.TemporaryDirectory() as kept:
        folder = Path(kept) / "in"
        shutil.copytree(CORPUS, folder)
        for file, content in contents.items():
            (folder / file).write_bytes(content)
        started = time.process_time()
        expected = ["in", "out"]
        try:
            import_scene(folder / name, Path(kept) / "out", ImportOptions(allow_missing=allow_missing))
        except Incomplete:
            pass
        except InputError:
            expected = ["in"]
        assert time.process_time() - started < _SECONDS
        assert sorted(path.name for path in Path(kept).iterdir()) == expected


@pytest.mark.parametrize("name", ["scene.xml", "old.xml", "scene.pbrt", "old.pbrt", "scene.gltf"])
def test_the_corpus_is_imported_whole(name: str, tmp_path: Path) -> None:
    """Changes of these files would test little if importers stopped at their first line."""
    found = import_scene(CORPUS / name, tmp_path / "out", ImportOptions())
    assert found.missing == []


@pytest.mark.parametrize("name", ["scene.xml", "old.xml", "scene.pbrt", "old.pbrt", "scene.gltf"])
def test_any_words(name: str) -> None:
    content = (CORPUS / name).read_bytes()

    @_QUIETLY
    @given(changes=CHANGES, allow_missing=st.booleans())
    def run(changes: list[Change], allow_missing: bool) -> None:
        try_import(name, {name: changed(content, changes)}, allow_missing=allow_missing)

    run()


@pytest.mark.parametrize("allow_missing", [False, True])
def test_a_mesh_of_points_without_triangles(allow_missing: bool) -> None:
    header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    header += "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
    mesh = f"{header}0 0 0\n1 0 0\n0 1 0\n".encode()
    try_import("scene.pbrt", {"a.ply": mesh}, allow_missing=allow_missing)


@pytest.mark.parametrize(("name", "part"), [("scene.xml", "a.vol"), ("scene.pbrt", "a.ply")])
def test_any_bytes_of_a_part(name: str, part: str) -> None:
    content = (CORPUS / part).read_bytes()

    @_QUIETLY
    @given(
        patches=st.lists(st.tuples(st.integers(0, len(content) - 1), st.binary(max_size=6)), max_size=4),
        length=st.integers(0, len(content)) | st.just(len(content)),
    )
    def run(patches: list[tuple[int, bytes]], length: int) -> None:
        made = bytearray(content)
        for at, patch in patches:
            made[at : at + len(patch)] = patch
        try_import(name, {part: bytes(made[:length])}, allow_missing=True)

    run()
