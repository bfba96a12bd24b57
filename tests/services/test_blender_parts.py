"""What of the add-on for Blender needs no Blender: light, files, film, the service's API, the zip."""

import importlib.util
import io
import struct
import zipfile
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import OpenImageIO
import pytest
from nocturne_api.service import Settings
from nocturne_blender import files, film, light
from nocturne_blender.service import Job, Service, ServiceError, has_ended
from nocturne_scene.formats.reading.colours import luminance_of
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.photometry import ies
from nocturne_scene.spectra import published
from nocturne_scene.spectra.rgb import xyz_to_rgb

from tests.services.served import served

_SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
_TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def _zip_maker() -> ModuleType:
    path = Path(__file__).parents[2] / "services" / "blender" / "make_zip.py"
    spec = importlib.util.spec_from_file_location("make_zip", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_watt_of_white_is_d65() -> None:
    """The constant is that of the tables which scenes are compiled with."""
    visible = published.visible_wavelengths()
    d65 = np.interp(visible, *published.illuminant("D65"))
    y_bar = published.observer("CIE 1931 2 degree")[:, 1]
    assert pytest.approx(683 * (d65 @ y_bar) / d65.sum(), rel=1e-5) == light.LUMENS_PER_WATT
    assert luminance_of(light.radiance([1, 1, 1])) == pytest.approx(light.LUMENS_PER_WATT)


def test_colours_go_there_and_back() -> None:
    """Blender's colours from X, Y, Z are those that the scene language has."""
    xyz = np.array([[0.3, 0.4, 0.5], [2.0, 1.0, 0.1]], np.float32)
    assert np.allclose(light.rgb_of_xyz(xyz * light.LUMENS_PER_WATT), xyz @ xyz_to_rgb().T, atol=1e-5)


def test_light_has_any_size_and_reflectance_has_not() -> None:
    """Radiance keeps its size as luminance; what reflects more than all is held."""
    assert light.radiance([0, 0, -1]) == 0.0
    assert light.radiance([20, 10, 0]) == {
        "rgb": [1.0, 0.5, 0.0],
        "luminance": pytest.approx(light.LUMENS_PER_WATT * (20 * 0.2126 + 10 * 0.7152)),
    }
    assert light.reflectance([1.5, 0.5, 0.5]) == {"rgb": [1.0, 0.5, 0.5]}
    assert light.reflectance([0.25, 0.25, 0.25]) == 0.25


def test_meshes_are_read_as_they_were_written(tmp_path: Path) -> None:
    """With normals and texture coordinates, by the scene compiler's own reader."""
    normals = np.tile(np.array([0, 0, 1], np.float32), (4, 1))
    coordinates = _SQUARE[:, :2] * np.float32(0.5)
    path = tmp_path / "square.ply"
    path.write_bytes(files.ply(_SQUARE, _TRIANGLES, normals, coordinates))
    found = load_mesh(path, "ply", normals=True)
    assert np.array_equal(found.vertices, _SQUARE)
    assert np.array_equal(found.indices, _TRIANGLES)
    assert found.normals is not None
    assert found.coordinates is not None
    assert np.array_equal(found.normals, normals)
    assert np.array_equal(found.coordinates, coordinates)


def _pixels(path: Path, kind: Any) -> Any:
    return OpenImageIO.ImageBuf(str(path)).get_pixels(kind)


def test_pictures_are_read_as_they_were_written(tmp_path: Path) -> None:
    """Floats without any loss, bytes as they are."""
    rng = np.random.default_rng(3)
    floats = rng.uniform(0, 30, (5, 7, 3)).astype(np.float32)
    (tmp_path / "sky.exr").write_bytes(files.exr(floats))
    assert np.array_equal(_pixels(tmp_path / "sky.exr", OpenImageIO.FLOAT), floats)
    for channels in (1, 3, 4):
        stored = rng.integers(0, 256, (5, 7, channels), np.uint8)
        path = tmp_path / "picture.png"
        path.write_bytes(files.png(stored))
        alpha = channels == 4  # OpenImageIO multiplies colours by alpha
        picked = slice(3, 4) if alpha else slice(None)
        assert np.array_equal(_pixels(path, OpenImageIO.UINT8)[..., picked], stored[..., picked])


@pytest.mark.parametrize("blend", [0.0, 0.4, 1.0])
def test_spots_fall_off_within_their_cone(blend: float) -> None:
    """Full on the axis, nothing beyond the edge, by a smooth step of the cosine in between."""
    cone = np.radians(50)
    lamp = ies.read(files.spot_photometry(cone, blend, 100.0))
    at = np.radians(lamp.vertical)
    edge = np.cos(cone / 2)
    assert lamp.candela[0, 0] == pytest.approx(100)
    assert np.all(lamp.candela[0, at > cone / 2 + 2e-6] == 0)
    inner = at <= np.arccos(edge + (1 - edge) * blend) - 1e-6
    assert np.allclose(lamp.candela[0, inner], 100)


def test_film_takes_tiles_of_any_place() -> None:
    """The bottom row comes first; tiles at the right and lower edge are cut."""
    shown = film.TiledImage(3, 5)
    tile = np.arange(2 * 1 * 4, dtype="<f4").reshape(1, 2, 4)
    # Tiles of 2 pixels: index 4 is the left one of the last row, cut to one row.
    answer = (
        b"NXY1" + struct.pack("<7I", 3, 5, 2, 1, 0, 9, 4) + struct.pack("<4I", 4, 16, 0, 9) + tile.tobytes()
    )
    assert not shown.take(answer)
    assert shown.cursor == "9.4"
    assert np.array_equal(shown.xyz[0, :2], tile[0, :, :3])
    assert np.array_equal(shown.y_error[0, :2, 0], tile[0, :, 3])
    assert shown.samples[0, :, 0].tolist() == [16, 16, 0]
    assert not np.any(shown.xyz[1:])


@pytest.mark.parametrize(
    "answer", [b"NXY2" + bytes(28), b"NXY1", b"NXY1" + struct.pack("<7I", 9, 9, 2, 0, 0, 0, 0)]
)
def test_film_refuses_other_bytes(answer: bytes) -> None:
    """In words."""
    with pytest.raises(ValueError, match="the service's"):
        film.TiledImage(3, 5).take(answer)


def test_service_renders_and_cancels(tmp_path: Path) -> None:
    """Upload, create, look, cancel: the calls that the engine makes, to the real API."""
    with served(Settings(data=tmp_path / "data", web=tmp_path / "web", port=0, grpc_port=0)) as api:
        _use(Service(f"http://127.0.0.1:{api.port}"))


def _use(service: Service) -> None:
    assert service.is_up()
    mesh = files.ply(_SQUARE, _TRIANGLES)
    sent = files.Files()
    surface = {"shape": {"type": "mesh", "asset": sent.add(mesh), "format": "ply"}}
    scene = {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0, 0, 3],
            "look_at": [0, 0, 0],
            "vertical_field_of_view_degrees": 40,
        },
        "surfaces": [surface | {"kernel": {"type": "lambertian", "reflectance": 0.5}}],
        "environment": {"radiance": light.radiance([1, 1, 1])},
    }
    assert list(service.upload(sent.by_digest)) == [1.0]
    assert list(service.upload(sent.by_digest)) == []
    render = service.create(Job("a square", scene, 16, 16, 4, {}))
    assert not has_ended(render)
    service.cancel(render["id"])
    assert has_ended(service.render(render["id"])) or service.render(render["id"])["state"] == "QUEUED"
    scene["surfaces"] = [surface | {"kernel": {"type": "velvet"}}]
    with pytest.raises(ServiceError, match=r"\$\.surfaces\[0\]\.kernel"):
        service.create(Job("", scene, 16, 16, 4, {}))


def test_no_service_is_told_in_words() -> None:
    """An address where nobody answers, and one that is none."""
    with pytest.raises(ServiceError, match="is not an address"):
        Service("here")
    assert not Service("http://127.0.0.1:9").is_up()


def test_zip_holds_the_add_on(tmp_path: Path) -> None:
    """All modules and the manifest at its top, the same bytes each time."""
    make = _zip_maker().make
    first, second = make(tmp_path / "one"), make(tmp_path / "two")
    assert first.read_bytes() == second.read_bytes()
    names = zipfile.ZipFile(io.BytesIO(first.read_bytes())).namelist()
    assert {"__init__.py", "blender_manifest.toml", "engine.py", "LICENSE"} <= set(names)
    assert not [name for name in names if "/" in name]
