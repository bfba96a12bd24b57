"""The command that counts how many scenes of others are imported."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.formats.reading.scene_writer import FilmSettings

from tests.corpus import means
from tests.corpus.__main__ import Tried, chosen, git_folder, is_scene, page, top_folder
from tests.corpus.trying import DARK, FAILED, LOSSY, NO_SCENE, REFUSED, STRICT, Outcome, tried
from tests.scene.formats.test_gltf import tree

HERE = Path(__file__).parent / "corpus"
# A lamp that faces away from the camera, from which nothing comes back.
_DARK = (
    '<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="40"/></sensor>'
    '<shape type="rectangle"><emitter type="area"/><transform name="to_world"><translate z="3"/></transform>'
    "</shape></scene>"
)


def test_patterns_choose_scenes_and_leave_out_parts() -> None:
    names = ["scenes/a.xml", "scenes/b/c.xml", "scenes/b/parts/d.xml", "scenes/e.png", "other/f.xml"]
    source = {"files": ["scenes/*"], "without": ["*/parts/*"]}
    assert chosen(names, source) == ["scenes/a.xml", "scenes/b/c.xml"]


def test_patterns_without_a_folder_are_of_the_whole_repository() -> None:
    patterns = ("0*/*.pbrt", "scene.pbrt", "scenes/*.xml", "a/b/c*/*.xml")
    assert [top_folder(pattern) for pattern in patterns] == ["", "", "scenes/", "a/b/"]


def test_clones_are_found_by_either_name(tmp_path: Path) -> None:
    subprocess.run(["git", "init", "--quiet", tmp_path / "owner+name"], check=True)
    assert git_folder(tmp_path, "owner/name") == tmp_path / "owner+name" / ".git"
    assert git_folder(tmp_path, "owner/other") is None


def test_what_comes_of_a_file(tmp_path: Path) -> None:
    pearl = tree() | {"materials": [{"extensions": {"KHR_materials_iridescence": {}}}]}
    (tmp_path / "pearl.gltf").write_text(json.dumps(pearl))
    (tmp_path / "broken.gltf").write_text("{")
    (tmp_path / "dark.xml").write_text(_DARK)
    assert tried(HERE / "scene.gltf", HERE, renders=True).kind == STRICT
    lossy = tried(tmp_path / "pearl.gltf", tmp_path, renders=True)
    assert (lossy.kind, lossy.reasons) == (LOSSY, ("no support for the extension KHR_materials_iridescence",))
    assert tried(tmp_path / "broken.gltf", tmp_path, renders=True).kind == REFUSED
    assert DARK in tried(tmp_path / "dark.xml", tmp_path, renders=True).reasons


def test_the_page_counts_by_format() -> None:
    kinds = (STRICT, STRICT, LOSSY, REFUSED, FAILED, NO_SCENE)
    found = [Tried("glTF 2.0", "a/b", f"{kind}.gltf", Outcome(kind, (f"why {kind}",))) for kind in kinds]
    text = page(found)
    assert "| glTF 2.0 | 5 | 2 | 1 | 1 | 1 | 1 | 0 |" in text
    assert "| 1 | glTF 2.0 | why refused |" in text
    assert "| a/b: refused.gltf | refused | why refused |" in text


def test_a_pbrt_file_without_shapes_is_no_scene(tmp_path: Path) -> None:
    light, ball = tmp_path / "light.pbrt", tmp_path / "ball.pbrt"
    light.write_text('WorldBegin\nLightSource "infinite"\n# Shape "sphere"\n')
    ball.write_text('WorldBegin\n  Shape "sphere"\n')
    assert (is_scene(light), is_scene(ball)) == (False, True)


def test_a_film_keeps_its_shape_with_few_pixels() -> None:
    found = means.small(FilmSettings(683, 512))
    assert found.width / found.height == pytest.approx(683 / 512, rel=1e-3)
    assert found.width * found.height < 4_000


def test_the_page_of_means_says_what_differs_and_why() -> None:
    one, error = np.ones(3), np.full(3, 0.001)
    rows = [
        means.Row("same.xml", means.Means(1.019 * one, error, one, error), ""),
        means.Row("gold.xml", means.Means(1.021 * one, error, one, error), "another table"),
        means.Row("torn.xml", None, "refused: no file"),
    ]
    text = means.page(rows)
    assert "2 files rendered by both: 1 within 2% in X, Y and Z, 1 beyond, 0 of them unexplained" in text
    assert "| gold.xml | +2.10% ± 0.14% |" in text
    assert "| torn.xml | refused: no file |" in text
