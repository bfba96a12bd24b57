"""pbrt's pictures of numbers, and what holes of a shape do to its light: against pbrt-v4's own code."""

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.textures.image_files import convert
from numpy.typing import NDArray

from tests.pictures import read_pixels, write_exr, write_picture
from tests.texture_files import levels_of

# (v / 255) of 128 by the sRGB curve, IEC 61966-2-1.
HALF = 0.21586


def imported(tmp_path: Path, body: str) -> tuple[dict[str, Any], list[str]]:
    folder = tmp_path / "in"
    folder.mkdir(exist_ok=True)
    head = 'Camera "perspective"\nWorldBegin\nLightSource "infinite"\n'
    (folder / "a.pbrt").write_text(f"{head}{body}\n")
    shutil.rmtree(tmp_path / "out", ignore_errors=True)
    found = import_scene(folder / "a.pbrt", tmp_path / "out", ImportOptions())
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document, found.notes


def numbers(tmp_path: Path, use: dict[str, Any], document: dict[str, Any]) -> NDArray[np.float32]:
    """What a use of a texture as a number looks up, as it would be compiled."""
    texture = document["textures"][use["texture"]]
    encoding = {"sRGB": "srgb", "linear": "linear"}[texture["encoding"]]
    made = convert(tmp_path / "out" / texture["asset"], 1, encoding)  # type: ignore[arg-type]
    return np.asarray(levels_of(made.content)[0][..., 0] * np.float32(use.get("gain", 1.0)))


def looked_up(tmp_path: Path, file: Path, given: str = "") -> NDArray[np.float32]:
    """Of a picture as `alpha`."""
    texture = f'Texture "holes" "float" "imagemap" "string filename" "{file.name}" {given}\n'
    document, _ = imported(tmp_path, f'{texture}Shape "disk" "texture alpha" "holes"')
    [surface] = document["surfaces"]
    assert surface["kernel"]["type"] == "mask"
    return numbers(tmp_path, surface["kernel"]["opacity"], document)


def picture(tmp_path: Path, name: str, channels: list[int], kind: Any = np.uint8) -> Path:
    (tmp_path / "in").mkdir(exist_ok=True)
    pixels = np.tile(np.array(channels, dtype=kind), (2, 2, 1))
    return write_picture(tmp_path / "in" / name, pixels)


# https://github.com/mmp/pbrt-v4/issues/247 and https://github.com/ototoi/pbrt-r4/issues/23: a black square of
# alpha 128 of 255 before a sky of 100 cd/m2 has 78.4 cd/m2, and 49.8 where the picture is linear.
@pytest.mark.parametrize(
    ("channels", "given", "expected"),
    [
        ([128], "", HALF),
        ([128], '"string encoding" "sRGB"', HALF),
        ([128], '"string encoding" "linear"', 128 / 255),
        ([128], '"string encoding" "gamma 2"', (128 / 255) ** 2),
        ([128], '"float scale" 0.5', HALF / 2),
        ([128], '"bool invert" true', 1 - HALF),
        ([128], '"bool invert" true "float scale" 0.5', 1 - HALF / 2),
        ([128], '"bool invert" true "float scale" 8', 0.0),
        # Alpha where it is not 1 everywhere, by the same curve.
        ([255, 255, 255, 128], "", HALF),
        ([255, 255, 255, 128], '"string encoding" "linear"', 128 / 255),
        ([128, 128, 128, 255], "", HALF),
        # The mean of three colours, no luminance.
        ([255, 0, 0], "", 1 / 3),
        ([0, 0, 128], "", HALF / 3),
        # Grey with alpha: pbrt reads the grey alone.
        ([128, 10], "", HALF),
    ],
)
def test_a_picture_of_numbers(tmp_path: Path, channels: list[int], given: str, expected: float) -> None:
    file = picture(tmp_path, "a.png", channels)
    assert looked_up(tmp_path, file, given) == pytest.approx(np.full((2, 2), expected), abs=1e-3)


def test_sixteen_bits_are_srgb_too(tmp_path: Path) -> None:
    file = picture(tmp_path, "a.png", [128 * 257], np.uint16)
    assert looked_up(tmp_path, file) == pytest.approx(np.full((2, 2), HALF), abs=1e-3)


def test_other_formats_have_their_own_encoding(tmp_path: Path) -> None:
    """JPEG is sRGB whatever is said, EXR linear."""
    file = picture(tmp_path, "a.jpg", [128] * 3)
    found = looked_up(tmp_path, file, '"string encoding" "linear"')
    assert found == pytest.approx(np.full((2, 2), HALF), abs=5e-3)
    write_exr(tmp_path / "in" / "a.exr", np.tile([0.1, 0.2, 0.6, 0.25], (2, 2, 1)), "RGBA")
    assert looked_up(tmp_path, tmp_path / "in" / "a.exr") == pytest.approx(np.full((2, 2), 0.25))
    write_exr(tmp_path / "in" / "b.exr", np.tile([0.1, 0.2, 0.6], (2, 2, 1)), "RGB")
    assert looked_up(tmp_path, tmp_path / "in" / "b.exr") == pytest.approx(np.full((2, 2), 0.3))


def test_encodings_are_those_of_pbrt(tmp_path: Path) -> None:
    file = picture(tmp_path, "a.png", [128])
    with pytest.raises(InputError, match='no encoding "log"; expected sRGB, linear or gamma'):
        looked_up(tmp_path, file, '"string encoding" "log"')


def test_a_colour_may_be_inverted(tmp_path: Path) -> None:
    picture(tmp_path, "a.png", [255, 128, 0])
    body = 'Texture "t" "spectrum" "imagemap" "string filename" "a.png" "bool invert" true\n'
    body += 'Material "diffuse" "texture reflectance" "t" Shape "disk"'
    document, _ = imported(tmp_path, body)
    [kernel] = document["kernels"].values()
    texture = document["textures"][kernel["reflectance"]["texture"]]
    assert texture["encoding"] == "linear"
    pixels = read_pixels(tmp_path / "out" / texture["asset"])
    assert pixels[0, 0] == pytest.approx([0, 1 - HALF, 1], abs=1e-3)


def test_numbers_and_colours_have_names_of_their_own(tmp_path: Path) -> None:
    """A texture of each kind, of one name, as makers of leaves write them."""
    picture(tmp_path, "a.png", [128])
    body = 'Texture "leaf" "spectrum" "constant" "rgb value" [0.1 0.4 0.1]\n'
    body += 'Texture "leaf" "float" "imagemap" "string filename" "a.png"\n'
    body += 'Material "diffuse" "texture reflectance" "leaf" Shape "disk" "texture alpha" "leaf"'
    document, _ = imported(tmp_path, body)
    assert document["kernels"]["diffuse"]["reflectance"] == {"rgb": [0.1, 0.4, 0.1]}
    assert "texture" in document["surfaces"][0]["kernel"]["opacity"]


LAMP = 'AreaLightSource "diffuse" "float scale" 1000 "bool twosided" true\n'


@pytest.mark.parametrize("given", ['"float alpha" 0', '"texture alpha" "nothing"', '"float alpha" -1'])
def test_a_lamp_that_is_not_there_lights_unseen(tmp_path: Path, given: str) -> None:
    """https://github.com/stig-atle/io_scene_pbrt/issues/28: no ray meets it, and it lights all the same."""
    texture = 'Texture "nothing" "float" "constant" "float value" 0\n'
    document, _ = imported(tmp_path, f'{texture}{LAMP} Shape "disk" {given}')
    [surface] = document["surfaces"]
    assert surface["kernel"] == {"type": "null"}
    assert surface["luminaire"] == {
        "radiance": {"illuminant": "D65", "luminance": 1000},
        "two_sided": True,
        "hidden_from": "camera_and_mirrors",
    }


def test_a_lamp_with_holes_lights_with_what_is_left(tmp_path: Path) -> None:
    """https://github.com/mmp/pbrt-v4/issues/247: the floor under half a lamp of 36.73 cd/m2 has 18.36."""
    document, _ = imported(tmp_path, f'{LAMP} Shape "disk" "float alpha" 0.25')
    assert document["surfaces"][0]["luminaire"]["radiance"]["luminance"] == 250
    (tmp_path / "in").mkdir(exist_ok=True)
    pixels = np.array([[[0], [255]]], dtype=np.uint8)
    write_picture(tmp_path / "in" / "a.png", pixels)
    texture = 'Texture "holes" "float" "imagemap" "string filename" "a.png" "float scale" 0.5\n'
    document, _ = imported(tmp_path, f'{texture}{LAMP} Shape "disk" "texture alpha" "holes"')
    [surface] = document["surfaces"]
    radiance = surface["luminaire"]["radiance"]
    assert radiance["grey"]
    assert radiance["spectrum"]["luminance"] == 500
    assert radiance["texture"] == surface["kernel"]["opacity"]["texture"]


@pytest.mark.parametrize("material", ["interface", "none", ""])
def test_an_interface_has_no_light(tmp_path: Path, material: str) -> None:
    """As pbrt warns: "Ignoring area light specification for shape with "interface" material"."""
    document, notes = imported(tmp_path, f'Material "{material}" {LAMP} Shape "disk" Shape "sphere"')
    assert not any("luminaire" in surface for surface in document["surfaces"])
    assert any('no light on shapes of an "interface" material' in note for note in notes)


def test_a_shape_of_an_object_has_no_light(tmp_path: Path) -> None:
    """As pbrt warns: "Area lights not supported with object instancing"."""
    body = f'ObjectBegin "lamp" {LAMP} Shape "sphere" ObjectEnd ObjectInstance "lamp"'
    document, notes = imported(tmp_path, body)
    [members] = document["groups"].values()
    assert "luminaire" not in members[0]
    assert any("no light on shapes of objects, as in pbrt" in note for note in notes)
