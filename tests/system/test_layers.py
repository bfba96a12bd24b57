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
    output = folder / f"{'-'.join(layers) or 'image'}.exr"
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


def lamp(name: str, x: float, z: float, kernel: Scene, **luminaire: Any) -> Scene:
    """A quad that emits."""
    return {**quad(name, x, z, kernel), "luminaire": {"radiance": 1.0, **luminaire}}


BLACK = {"type": "lambertian", "reflectance": 0.0}
HALF = np.s_[:, : EDGE // 2]
REST = np.s_[:, EDGE // 2 :]


def emission(folder: Path, *surfaces: Scene) -> Any:
    return render(scene(*surfaces), folder, "emission")["emission.part"]


def test_tell_the_part_of_a_pixel_that_emits(tmp_path: Path) -> None:
    """Left edge at 9.25 pixels from the left: 7 pixels are full, and one to three quarters, of 16 samples."""
    left = (9.25 - EDGE / 2) / EDGE
    found = emission(tmp_path, lamp("lamp", left, 3.0, BLACK))
    np.testing.assert_array_equal(found[:, :9], 0.0)
    np.testing.assert_array_equal(found[:, 10:], 1.0)
    # Samples of a pixel are spread evenly across it.
    np.testing.assert_allclose(found[:, 9], 0.75, atol=1 / 16)


@pytest.mark.parametrize(
    ("luminaire", "part"),
    [
        ({}, 1.0),
        # Of one line: at the wavelengths of most samples it has no radiance.
        ({"radiance": {"lines": [{"nm": 589.0, "power": 1.0}]}}, 1.0),
        ({"profile": {"cosine_power": 20.0}}, 1.0),
        ({"hidden_from": "camera"}, 0.0),
        ({"hidden_from": "camera_and_mirrors"}, 0.0),
    ],
)
def test_what_emits_is_known_whatever_its_light(luminaire: Scene, part: float, tmp_path: Path) -> None:
    found = emission(tmp_path, lamp("lamp", -1.0, 3.0, BLACK, **luminaire), RIGHT)
    np.testing.assert_array_equal(found[HALF], part)
    np.testing.assert_array_equal(found[REST], 0.0)


def test_a_luminaire_is_seen_from_the_side_that_emits(tmp_path: Path) -> None:
    back = lamp("lamp", -1.0, 3.0, BLACK)
    back["shape"].update(corner=[0.0, -0.5, -3.0], edge_u=[-1, 0, 0])
    assert not emission(tmp_path, back, RIGHT).any()
    back["luminaire"]["two_sided"] = True
    np.testing.assert_array_equal(emission(tmp_path, back, RIGHT)[HALF], 1.0)


def test_a_photometric_file_tells_where_a_luminaire_emits(tmp_path: Path) -> None:
    """Downwards and up to 60 degrees; the sensor looks at it along the axis, and across it."""
    ies = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 1 1 0\n1 1 1\n0 60 90\n0\n100 0 0\n"
    (tmp_path / "lamp.ies").write_text(ies)
    for axis, part in (([0, 0, 1], 1.0), ([1, 0, 0], 0.0)):
        zero = [0, 1, 0]
        profile = {"asset": "lamp.ies", "axis": axis, "zero": zero}
        found = emission(tmp_path, lamp("lamp", -1.0, 3.0, BLACK, profile=profile), RIGHT)
        np.testing.assert_array_equal(found[HALF], part)


def test_a_luminaire_is_seen_through_holes_and_not_through_what_hides_it(tmp_path: Path) -> None:
    far = lamp("lamp", -1.0, 3.0, BLACK)
    for opacity, part in ((0.0, 1.0), (1.0, 0.0)):
        mask = quad("mask", -1.0, 1.0, {"type": "mask", "kernel": BLACK, "opacity": opacity})
        np.testing.assert_array_equal(emission(tmp_path, mask, far, RIGHT)[HALF], part)


def test_light_that_lets_rays_through_is_seen(tmp_path: Path) -> None:
    """It emits, and shows the surfaces behind it."""
    glow = lamp("glow", -1.0, 1.0, {"type": "mask", "kernel": BLACK, "opacity": 0.0})
    np.testing.assert_array_equal(emission(tmp_path, glow, LEFT, RIGHT)[HALF], 1.0)


def test_the_dark_parts_of_a_texture_do_not_emit(tmp_path: Path) -> None:
    """But for the texels on both sides of an edge, which are mixed."""
    pixels = np.zeros((1, EDGE, 3), dtype=np.float32)
    pixels[:, EDGE // 2 :] = 1.0
    output = oiio.ImageOutput.create(str(tmp_path / "picture.exr"))
    assert output is not None
    assert output.open(str(tmp_path / "picture.exr"), oiio.ImageSpec(EDGE, 1, 3, oiio.FLOAT))
    assert output.write_image(pixels)
    output.close()
    document = scene(lamp("screen", -0.5, 3.0, BLACK, radiance={"texture": "picture", "spectrum": 1.0}))
    document["textures"] = {"picture": {"asset": "picture.exr", "wrap": "clamp"}}
    found = render(document, tmp_path, "emission")["emission.part"]
    np.testing.assert_array_equal(found[:, : EDGE // 2 - 1], 0.0)
    np.testing.assert_array_equal(found[:, EDGE // 2 + 1 :], 1.0)


def test_panoramas_of_luminaires_have_emission_without_being_asked(tmp_path: Path) -> None:
    look = {"type": "panorama", "position": [0, 0, 0], "look_at": [0, 0, -1]}
    for surfaces, found in (((lamp("lamp", 0.0, 3.0, BLACK),), True), ((LEFT,), False)):
        document = {**scene(*surfaces), "sensor": look}
        assert ("emission.part" in render(document, tmp_path)) is found
    both = render({**scene(lamp("lamp", 0.0, 3.0, BLACK)), "sensor": look}, tmp_path, "depth")
    assert {"depth.Z", "emission.part"} <= both.keys()
    assert "emission.part" not in render(scene(lamp("lamp", 0.0, 3.0, BLACK)), tmp_path)


def test_the_image_has_the_same_bits_with_and_without(tmp_path: Path) -> None:
    channels = {name for each in CHANNELS.values() for name in each}
    without, beside = render(scene(LEFT), tmp_path), render(scene(LEFT), tmp_path, "albedo", "depth")
    assert beside.keys() - without.keys() == {*CHANNELS["albedo"], *CHANNELS["depth"]}
    assert not channels & without.keys()
    images = [Image.read(tmp_path / name) for name in ("image.exr", "albedo-depth.exr")]
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
