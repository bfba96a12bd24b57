"""Layers by nocturne-trace: of a scene whose depths, normals and colours are known."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.render import LocalRender, render_scene
from nocturne_scene.layers import CHANNELS, OBJECTS

from tests.system.images import Image, differing_values

pytestmark = pytest.mark.system

EDGE = 16
Scene = dict[str, Any]


def quad(name: str, x: float, z: float, kernel: Scene) -> Scene:
    """A square of 1 m whose left edge is at x, z metres in front of the sensor, turned to it."""
    shape = {"type": "quad", "corner": [x, -0.5, -z], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}
    return {"name": name, "shape": shape, "kernel": kernel}


def scene(*surfaces: Scene, sensor: Scene | None = None) -> Scene:
    look = {"type": "orthographic", "position": [0, 0, 0], "look_at": [0, 0, -1], "height": 1}
    return {
        "nocturne": 1,
        "sensor": {**look, **(sensor or {})},
        "environment": {"radiance": 1},
        "surfaces": [*surfaces],
    }


def render(document: Scene, folder: Path, *layers: str) -> dict[str, Any]:
    """Channels of the image, and the names of objects."""
    (folder / "scene.json").write_text(json.dumps(document))
    output = folder / f"{'-'.join(layers)}.exr"
    render_scene(LocalRender(folder / "scene.json", [output], EDGE, EDGE, 8, 2, layers=layers))
    with OpenEXR.File(str(output), separate_channels=True) as file:
        names = {"objects": json.loads(file.header().get(OBJECTS, "[]"))}
        return {name: channel.pixels for name, channel in file.channels().items()} | names


LEFT = quad("red", -1.0, 3.0, {"type": "lambertian", "reflectance": {"rgb": [0.6, 0.1, 0.1]}})
RIGHT = quad("mirror", 0.0, 5.0, {"type": "lambertian", "reflectance": 0.25})


def test_tell_where_surfaces_are_and_which(tmp_path: Path) -> None:
    found = render(scene(LEFT, RIGHT), tmp_path, *CHANNELS)
    left, right = np.s_[:, : EDGE // 2], np.s_[:, EDGE // 2 :]
    assert found["objects"] == ["red", "mirror"]
    for name, one, other in (
        ("depth.Z", 3.0, 5.0),
        ("P.Z", -3.0, -5.0),
        ("N.Z", 1.0, 1.0),
        ("N.X", 0.0, 0.0),
        ("id.object", 1.0, 2.0),
        ("id.material", 1.0, 2.0),
    ):
        np.testing.assert_allclose(found[name][left], one, atol=1e-5, err_msg=name)
        np.testing.assert_allclose(found[name][right], other, atol=1e-5, err_msg=name)
    middles = (np.arange(EDGE) + 0.5) / EDGE - 0.5
    np.testing.assert_allclose(found["P.X"], np.broadcast_to(middles, (EDGE, EDGE)), atol=1e-5)
    np.testing.assert_allclose(found["P.Y"], np.broadcast_to(-middles[:, None], (EDGE, EDGE)), atol=1e-5)


def test_tell_colours(tmp_path: Path) -> None:
    found = render(scene(LEFT, RIGHT), tmp_path, "albedo")
    right = np.s_[:, EDGE // 2 :]
    for channel in CHANNELS["albedo"]:
        np.testing.assert_allclose(found[channel][right], 0.25, rtol=1e-4)
    red, green, blue = (found[channel][4, 4] for channel in CHANNELS["albedo"])
    # The spectrum that a document's colour becomes has it under D65, not under white of equal energy.
    assert (red, green, blue) == pytest.approx((0.6, 0.1, 0.1), abs=0.05)


def test_nothing_is_told_where_nothing_is(tmp_path: Path) -> None:
    found = render(scene(LEFT), tmp_path, "depth", "object", "albedo")
    assert np.all(found["depth.Z"][:, -1] == 1e10)
    assert np.all(found["id.object"][:, -1] == 0.0)
    assert np.all(found["albedo.G"][:, -1] == 0.0)


def test_holes_are_seen_through(tmp_path: Path) -> None:
    hole = quad("hole", -1.0, 1.0, {"type": "mask", "kernel": LEFT["kernel"], "opacity": 0.0})
    found = render(scene(hole, LEFT, RIGHT), tmp_path, "depth")
    np.testing.assert_allclose(found["depth.Z"][:, : EDGE // 2], 3.0, atol=1e-5)


def test_positions_are_the_documents_far_from_its_origin(tmp_path: Path) -> None:
    far = {"position": [1e5, 0, 0], "look_at": [1e5, 0, -1]}
    found = render(scene(quad("far", 1e5 - 0.5, 3.0, RIGHT["kernel"]), sensor=far), tmp_path, "position")
    # A float of that size has steps of 1/128 m.
    np.testing.assert_allclose(found["P.X"], 1e5, atol=0.51)
    np.testing.assert_allclose(found["P.Z"], -3.0, atol=1e-5)


def test_the_image_has_the_same_bits_with_and_without(tmp_path: Path) -> None:
    channels = {name for each in CHANNELS.values() for name in each}
    without, beside = render(scene(LEFT), tmp_path), render(scene(LEFT), tmp_path, "albedo", "depth")
    assert beside.keys() - without.keys() == {*CHANNELS["albedo"], *CHANNELS["depth"]}
    assert not channels & without.keys()
    images = [Image.read(tmp_path / name) for name in (".exr", "albedo-depth.exr")]
    assert differing_values(images[0], Image(**{**vars(images[1]), "further": {}})) == {}


def test_another_reader_groups_them(tmp_path: Path) -> None:
    render(scene(LEFT), tmp_path, "albedo", "object")
    picture = oiio.ImageInput.open(str(tmp_path / "albedo-object.exr"))
    assert picture is not None
    assert {*CHANNELS["albedo"], "id.object", "X", "n"} <= {*picture.spec().channelnames}
    picture.close()


def test_names_that_there_are_not_are_told(tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError) as refused:
        render(scene(LEFT), tmp_path, "albedo", "ao")
    assert [each.place for each in refused.value.problems] == ["$.layers"]
    assert "there is no 'ao'; expected albedo, normal, depth" in str(refused.value.problems[0])
