"""File > Render in a real Blender with a real service: images, passes, cancelling, animations, the zip."""

import os
import re
from pathlib import Path

import httpx
import numpy as np
import pytest

from tests.blender.blender import TOP, Rendered, render, run
from tests.system.free_ports import free_port_pair
from tests.system.up import NOCTURNE, Up

pytestmark = [pytest.mark.blender, pytest.mark.system]

_HERE = Path(__file__).parent
_SAMPLES = 256
# Of the mean over pixels that show diffuse surfaces.
_AGREE = 0.02


# Cycles' table of 256 leaves out both ends of the shutter's time: an edge that crosses the image is seen from
# 0.0020 to 0.9941.
_OPEN_IN_CYCLES = (0.5 / 256, 254.5 / 256)


def _both(folder: Path, service: Up, scene: str, *words: str) -> tuple[Rendered, Rendered]:
    """By ours, with `words`, and by Cycles."""
    samples = ("--samples", str(_SAMPLES))
    ours = render(folder, scene, "NOCTURNE", "--url", service.url, *samples, *words)
    return ours, render(folder, scene, "CYCLES", *samples)


def _mean(image: Rendered, rows: slice = slice(None), columns: slice = slice(None)) -> float:
    return float(image.rgb[rows, columns].mean())


def test_factory_scene_agrees_with_cycles(running_service: Up, tmp_path: Path) -> None:
    """Cube, lamp and camera as Blender starts: watts of a point lamp and a grey world."""
    ours, cycles = _both(tmp_path, running_service, "factory")
    assert np.allclose(ours.rgb[:8].mean((0, 1)), cycles.rgb[:8].mean((0, 1)), rtol=1e-3)
    cube = (slice(30, 66), slice(44, 84))
    assert _mean(ours, *cube) == pytest.approx(_mean(cycles, *cube), rel=_AGREE)


def test_principled_materials_agree_with_cycles(running_service: Up, tmp_path: Path) -> None:
    """The cube's own Principled BSDF: a rough dielectric over a diffuse base."""
    ours, cycles = _both(tmp_path, running_service, "plastic")
    cube = (slice(30, 66), slice(44, 84))
    assert _mean(ours, *cube) == pytest.approx(_mean(cycles, *cube), rel=_AGREE)


def test_a_shifted_orthographic_camera_sees_what_cycles_sees(running_service: Up, tmp_path: Path) -> None:
    ours, cycles = _both(tmp_path, running_service, "aside")
    # Half of the image each, in one of which is the cube.
    for part in (slice(0, 64), slice(64, 128)):
        assert _mean(ours, columns=part) == pytest.approx(_mean(cycles, columns=part), rel=_AGREE)
    seen = [image.rgb.mean(axis=2) > 2 * image.rgb[0, 0].mean() for image in (ours, cycles)]
    assert np.mean(seen[0] != seen[1]) < _AGREE
    assert "support" not in ours.said


def test_passes_hold_the_image_in_absolute_units(running_service: Up, tmp_path: Path) -> None:
    """X, Y, Z in cd/m2 belong to the combined image; each pixel has its error and its samples."""
    ours = render(tmp_path, "factory", "NOCTURNE", "--url", running_service.url, "--samples", "16")
    xyz, error, samples = (ours.passes[name] for name in ("XYZ", "Y Error", "Samples"))
    # The world is 0.05 of white, 183.142 cd/m2.
    assert xyz[0, 0, 1] == pytest.approx(ours.rgb[0, 0] @ [0.2126, 0.7152, 0.0722] * 183.142, rel=1e-3)
    assert np.all(samples == 16)
    assert np.all(error >= 0)
    assert np.any(error > 0)


def test_room_with_area_lamps_and_textures_agrees_with_cycles(running_service: Up, tmp_path: Path) -> None:
    """Rectangle, disc and ellipse of watts, a soft spot, an instance, a picture on a wall."""
    ours, cycles = _both(tmp_path, running_service, "room")
    assert _mean(ours) == pytest.approx(_mean(cycles), rel=_AGREE)
    for part in (slice(0, 48), slice(48, 96)):
        assert _mean(ours, part) == pytest.approx(_mean(cycles, part), rel=_AGREE)


def test_spheres_under_a_sky_agree_with_cycles(running_service: Up, tmp_path: Path) -> None:
    """A turned HDR picture and a sun: the sky itself, the floor, and the diffuse ball."""
    ours, cycles = _both(tmp_path, running_service, "spheres")
    ball, floor, sky = (
        (slice(38, 58), slice(80, 100)),
        (slice(76, 96), slice(None)),
        (slice(0, 20), slice(None)),
    )
    for part in (ball, floor, sky):
        assert _mean(ours, *part) == pytest.approx(_mean(cycles, *part), rel=_AGREE)
    assert "support" not in ours.said


def test_fog_and_hair_agree_with_cycles(running_service: Up, tmp_path: Path) -> None:
    """An OpenVDB file's density, placed and scaled; curves; the floor between them."""
    ours, cycles = _both(tmp_path, running_service, "cloud")
    fog, hair = (slice(30, 62), slice(26, 52)), (slice(30, 62), slice(76, 102))
    assert _mean(ours) == pytest.approx(_mean(cycles), rel=_AGREE)
    for part in (fog, hair):
        assert _mean(ours, *part) == pytest.approx(_mean(cycles, *part), rel=_AGREE)
    assert "support" not in ours.said


def test_a_crowd_agrees_with_cycles(running_service: Up, tmp_path: Path) -> None:
    """So many instances that their placements are in a file."""
    ours, cycles = _both(tmp_path, running_service, "crowd")
    for part in (slice(0, 40), slice(40, 70), slice(70, 96)):
        assert _mean(ours, part) == pytest.approx(_mean(cycles, part), rel=_AGREE)
    newest = httpx.get(f"{running_service.url}/v1/renders").json()["renders"][0]
    document = httpx.get(f"{running_service.url}/v1/renders/{newest['id']}/scene.json").json()
    assert [sorted(each) for each in document["instances"]] == [["group", "placements"]]


def test_what_moves_is_blurred_as_by_cycles(running_service: Up, tmp_path: Path) -> None:
    """Boxes that turn, of which one moves and one grows, and the camera."""
    cycles_time = ("--open", *map(str, _OPEN_IN_CYCLES))
    ours, cycles = _both(tmp_path, running_service, "moving", *cycles_time)
    for part in (slice(0, 64), slice(64, 88), slice(88, 128)):
        assert _mean(ours, columns=part) == pytest.approx(_mean(cycles, columns=part), rel=_AGREE)
    # How bright each column is says where everything was, for how long.
    columns = [image.rgb[20:76].reshape(56, 16, 8, 3).mean(axis=(0, 2, 3)) for image in (ours, cycles)]
    assert columns[0] == pytest.approx(columns[1], rel=_AGREE)
    assert "taken as still" not in ours.said


def test_cancelling_in_blender_cancels_at_the_service(running_service: Up) -> None:
    """Escape while the image grows: the render ends there, and Blender goes on."""
    run(_HERE / "cancelling.py", running_service.url)
    newest = httpx.get(f"{running_service.url}/v1/renders").json()["renders"][0]
    assert newest["state"] == "CANCELLED"


def test_frames_of_an_animation_are_renders(running_service: Up, tmp_path: Path) -> None:
    """Each frame is one, named by its number, and each is written."""
    run(_HERE / "animating.py", running_service.url, str(tmp_path))
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["0001.png", "0002.png"]
    names = [each["name"] for each in httpx.get(f"{running_service.url}/v1/renders").json()["renders"]]
    assert names[:2] == ["Scene, frame 2", "Scene, frame 1"]


def test_errors_are_told_in_words(tmp_path: Path) -> None:
    """No service at an address: the render fails, and says what to do."""
    with pytest.raises(AssertionError, match=re.escape("start a service with `nocturne up`")):
        render(tmp_path, "factory", "NOCTURNE", "--url", "http://127.0.0.1:9")


def test_zip_installs_as_an_extension_and_starts_a_service(tmp_path: Path) -> None:
    """What `make dist` builds, in a Blender without anything else: installed, switched on, File > Render."""
    run(TOP / "services" / "blender" / "make_zip.py", str(tmp_path / "dist"))
    run(_HERE / "installing.py", str(tmp_path), str(NOCTURNE), str(free_port_pair()))
    assert (tmp_path / "image.png").stat().st_size > 0


@pytest.mark.skipif("NOCTURNE_SCREENSHOTS" not in os.environ, reason="`make blender` makes it")
def test_picture_for_the_page(running_service: Up, tmp_path: Path) -> None:
    """Of the spheres, for docs/how-to/blender.md."""
    picture = Path(os.environ["NOCTURNE_SCREENSHOTS"]) / "spheres.png"
    size = ("--size", "480", "270", "--samples", "192", "--picture", str(picture))
    render(tmp_path, "spheres", "NOCTURNE", "--url", running_service.url, *size)
    assert picture.stat().st_size > 0
