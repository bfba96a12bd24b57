"""Light for models without any: its illuminance against integrals, and when it is added."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.reading.environments import overcast_sky, studio
from nocturne_scene.formats.reading.options import Imported, ImportOptions

from tests.pictures import write_exr
from tests.scene.formats.test_gltf import tree


def imported(tmp_path: Path, *, glows: bool = False, **options: Any) -> tuple[dict[str, Any], Imported]:
    scene = tree()
    scene["materials"] = [{"emissiveFactor": [float(glows)] * 3}]
    (tmp_path / "a.gltf").write_text(json.dumps(scene))
    found = import_scene(tmp_path / "a.gltf", tmp_path / "out", ImportOptions(**options))
    return json.loads(found.document.read_text()), found


def irradiance(picture: np.ndarray, towards: np.ndarray) -> float:
    """Of a surface that faces a direction of the picture's frame: x its middle, y to its left, z up."""
    rows, columns = picture.shape[:2]
    polar = (np.arange(rows) + 0.5) * np.pi / rows
    azimuth = np.pi - (np.arange(columns) + 0.5) * 2 * np.pi / columns
    flat = np.sin(polar)[:, None]
    directions = np.stack(
        np.broadcast_arrays(flat * np.cos(azimuth), flat * np.sin(azimuth), np.cos(polar)[:, None]), axis=-1
    )
    angle = flat * (np.pi / rows) * (2 * np.pi / columns)
    return float(np.sum(picture[..., 0] * np.maximum(directions @ towards, 0) * angle))


def test_the_overcast_sky_gives_white_paper_one_candela_per_square_metre() -> None:
    """E = pi lx on level ground, and below the horizon what ground of 20 % sends back."""
    assert irradiance(overcast_sky(), np.array([0, 0, 1.0])) == pytest.approx(np.pi, rel=1e-3)
    assert irradiance(overcast_sky(), np.array([0, 0, -1.0])) == pytest.approx(0.2 * np.pi, rel=1e-3)


def test_the_studio_lights_what_faces_the_camera_as_much() -> None:
    assert irradiance(studio(), np.array([1.0, 0, 0])) == pytest.approx(np.pi, rel=1e-3)
    # The key light is to the left of someone who stands at the camera and looks at the model: on the model's
    # right, which for someone who stands there and looks at the camera is the right.
    assert irradiance(studio(), np.array([0.7, 0.7, 0])) > 1.3 * irradiance(
        studio(), np.array([0.7, -0.7, 0])
    )


def test_a_model_without_light_gets_the_sky_and_says_so(tmp_path: Path) -> None:
    document, found = imported(tmp_path)
    assert document["environment"]["asset"] == "textures/sky.exr"
    assert any("--light" in note for note in found.notes)


def test_what_glows_gets_light_only_if_asked(tmp_path: Path) -> None:
    document, _ = imported(tmp_path, glows=True)
    assert "environment" not in document


def test_the_picture_is_seen_by_what_faces_the_camera(tmp_path: Path) -> None:
    document, _ = imported(tmp_path, glows=True, light="studio")
    assert document["environment"]["forward"] == pytest.approx([0, 0, 1])
    assert document["environment"]["up"] == pytest.approx([0, 1, 0])


def test_a_picture_of_ones_own(tmp_path: Path) -> None:
    write_exr(tmp_path / "own.exr", np.ones((4, 8, 3)), "RGB")
    document, found = imported(tmp_path, light=str(tmp_path / "own.exr"))
    asset = found.document.parent / document["environment"]["asset"]
    assert asset.read_bytes() == (tmp_path / "own.exr").read_bytes()


def test_no_such_picture(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected sky, studio or a picture"):
        imported(tmp_path, light="dusk")
    assert not (tmp_path / "out").exists()


def test_what_is_left_is_there_to_be_edited(tmp_path: Path) -> None:
    scene = tree()
    scene["materials"][0]["extensions"] = {"KHR_materials_iridescence": {}}
    (tmp_path / "a.gltf").write_text(json.dumps(scene))
    with pytest.raises(Incomplete, match="iridescence") as caught:
        import_scene(tmp_path / "a.gltf", tmp_path / "out", ImportOptions())
    document = json.loads(caught.value.imported.document.read_text())
    assert "iridescence" in document["note"]
    assert len(document["surfaces"]) == 1


def test_a_draft_is_replaced_unless_it_was_edited(tmp_path: Path) -> None:
    scene = tree()
    scene["materials"][0]["extensions"] = {"KHR_materials_iridescence": {}}
    file, out = tmp_path / "a.gltf", tmp_path / "out"
    file.write_text(json.dumps(scene))
    with pytest.raises(Incomplete):
        import_scene(file, out, ImportOptions())
    with pytest.raises(Incomplete):
        import_scene(file, out, ImportOptions())
    (out / "scene.json").write_text((out / "scene.json").read_text() + " ")
    with pytest.raises(InputError, match="not an empty folder"):
        import_scene(file, out, ImportOptions(allow_missing=True))
