"""Textures are made once for each use, and parameters that vary by one refer to it; meshes keep its
coordinates."""

import struct
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import InputError
from nocturne_scene.library_words import said_by

from tests.texture_files import levels_of

from .conftest import Compile, expect_problem

SQUARE = {
    "type": "mesh",
    "vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    "triangles": [[0, 1, 2], [0, 2, 3]],
}
COORDINATES = [[0, 0], [1, 0], [1, 1], [0, 1]]


@pytest.fixture
def picture(tmp_path: Path, blobs: BlobStore) -> Any:
    """Put a picture of so many channels into the blob store, and return its asset reference."""

    def put(channels: int, name: str = "a.png") -> str:
        form = oiio.UINT8 if name.endswith("png") else oiio.FLOAT
        buffer = oiio.ImageBuf(oiio.ImageSpec(4, 4, channels, form))
        buffer.set_pixels(oiio.ROI(), np.full((4, 4, channels), 0.5, dtype=np.float32))
        buffer.write(str(tmp_path / name))
        return f"sha256:{blobs.put((tmp_path / name).read_bytes())}"

    return put


def pixel(blobs: BlobStore, texture: scene_pb2.Texture) -> Any:
    return levels_of(blobs.path(texture.blob.hex()).read_bytes())[0][1, 1]


def test_a_colour_texture_brings_the_table_of_spectra(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, picture: Any
) -> None:
    document["textures"] = {"wood": {"asset": picture(3), "wrap": "clamp"}}
    use = {"texture": "wood", "spectrum": 0.5, "scale": [2, 3], "offset": [0.25, 0]}
    document["surfaces"][1]["kernel"]["reflectance"] = use
    scene = compiled(document)
    [texture] = scene.textures
    assert (texture.channels, texture.clamp) == (3, True)
    # sRGB, IEC 61966-2-1: 128 of 255 is 0.2159.
    assert pixel(blobs, texture) == pytest.approx([0.2159] * 3, abs=1e-3)
    reflectance = scene.kernels[scene.surfaces[1].kernel].lambertian.reflectance
    found = reflectance.texture
    assert (found.scale_u, found.scale_v, found.offset_u, found.gain, found.bias) == (2, 3, 0.25, 1, 0)
    assert list(scene.spectra[reflectance.spectrum].values) == [0.5]
    size = 4 * scene.rgb_table.resolution + 36 * scene.rgb_table.resolution**3
    assert blobs.size(scene.rgb_table.blob.hex()) == size


def test_opacity_leaves_colours_as_they_are_stored(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, tmp_path: Path
) -> None:
    """Otherwise leaves of a tree on a transparent ground would have dark rims, and half-transparent parts
    half their colour."""
    buffer = oiio.ImageBuf(oiio.ImageSpec(4, 4, 4, oiio.UINT8))
    # The library has colours times opacity, and writes them without.
    buffer.set_pixels(oiio.ROI(), np.full((4, 4, 4), [0.25, 0.25, 0.25, 0.5], dtype=np.float32))
    buffer.write(str(tmp_path / "a.png"))
    asset = f"sha256:{blobs.put((tmp_path / 'a.png').read_bytes())}"
    document["surfaces"][1]["kernel"]["reflectance"] = {"texture": {"asset": asset}}
    [texture] = compiled(document).textures
    assert pixel(blobs, texture) == pytest.approx([0.2159] * 3, abs=4e-3)


def test_a_sharp_texture_is_one_of_its_own(document: dict[str, Any], compiled: Compile, picture: Any) -> None:
    asset = picture(3)
    first, second = (
        {"type": "lambertian", "reflectance": {"texture": {"asset": asset, "sharp": sharp}}}
        for sharp in (True, False)
    )
    document["surfaces"][1]["kernel"] = {"type": "blend", "first": first, "second": second, "weight": 0.5}
    assert sorted(texture.sharp for texture in compiled(document).textures) == [False, True]


def test_a_number_is_linear_and_one_file_serves_both(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, picture: Any
) -> None:
    asset = picture(3)
    document["surfaces"][1]["kernel"] = {
        "type": "conductor",
        "index": "Al",
        "roughness": {"texture": {"asset": asset}, "gain": 0.5, "bias": 0.1},
    }
    mask = {"type": "mask", "kernel": "white", "opacity": {"texture": {"asset": asset}}}
    document["surfaces"][0]["kernel"] = mask
    scene = compiled(document)
    [texture] = scene.textures
    assert texture.channels == 1
    assert pixel(blobs, texture) == pytest.approx([0.5], abs=3e-3)
    alpha = scene.kernels[scene.surfaces[1].kernel].conductor.roughness.alpha_u.texture
    assert (alpha.gain, alpha.bias) == (0.5, 0.1)
    assert not scene.HasField("rgb_table")


def test_floating_point_pictures_are_linear_and_grey_ones_are_factors(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, picture: Any
) -> None:
    document["surfaces"][1]["luminaire"]["radiance"] = {
        "texture": {"asset": picture(1, "a.exr")},
        "spectrum": {"illuminant": "D65", "luminance": 10},
    }
    scene = compiled(document)
    assert scene.luminaires[0].radiance.HasField("texture")
    assert scene.textures[0].channels == 1
    assert pixel(blobs, scene.textures[0]) == pytest.approx([0.5])


def test_normals_and_heights(document: dict[str, Any], compiled: Compile, picture: Any) -> None:
    document["textures"] = {"bumps": {"asset": picture(1)}}
    document["surfaces"][1] |= {
        "normal_map": {"texture": {"asset": picture(3, "n.png")}},
        "bump_map": {"texture": "bumps", "height": 0.002},
    }
    scene = compiled(document)
    surface = scene.surfaces[1]
    assert [scene.textures[use.texture].channels for use in (surface.normal_map, surface.bump_map)] == [3, 1]
    assert surface.bump_map.gain == 0.002


def test_photons_from_luminaires_are_not_for_meters_beside_tilted_normals(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, picture: Any
) -> None:
    """Sun on a floor with a normal map, seen by a film from a low angle: a fifth less by these
    than by photons from the film."""
    document["surfaces"][1]["normal_map"] = {"texture": {"asset": picture(3, "n.png")}}
    meter = {"type": "irradiance_meter", "position": [0, 0, 1], "normal": [0, 0, -1], "height": 1}
    document |= {"sensor": meter, "tracing": {"direction": "forward"}}
    expect_problem(document, blobs, "$.tracing.direction", 'expected "adjoint"')
    document["tracing"] = {"direction": "auto"}
    assert compiled(document).tracing.direction == scene_pb2.DIRECTION_ADJOINT


def test_a_texture_needs_coordinates(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, picture: Any
) -> None:
    kernel = {"type": "lambertian", "reflectance": {"texture": {"asset": picture(3)}}}
    document["surfaces"][2] = {"shape": SQUARE, "kernel": kernel}
    with pytest.raises(InputError, match=r"\$\.surfaces\[2\]\.shape: .* no texture coordinates"):
        compiled(document)
    document["surfaces"][2]["shape"] = SQUARE | {"texture_coordinates": COORDINATES}
    mesh = compiled(document).surfaces[2].mesh
    assert mesh.texture_coordinates
    blob = blobs.path(mesh.blob.hex()).read_bytes()
    assert blob[48:80] == struct.pack("<8f", 0, 0, 1, 0, 1, 1, 0, 1)
    document["surfaces"][2]["kernel"] = "white"
    assert not compiled(document).surfaces[2].mesh.texture_coordinates


def test_a_smooth_mesh_has_normals_that_turn_with_it(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    turn = {"axis": [1, 0, 0], "degrees": 90}
    roof = SQUARE | {"vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]], "smooth": True}
    document["surfaces"][2] = {"shape": roof, "kernel": "white"}

    def normals() -> Any:
        mesh = compiled(document).surfaces[2].mesh
        assert mesh.normals
        return np.frombuffer(blobs.path(mesh.blob.hex()).read_bytes(), "<f4", 12, 48).reshape(4, 3)

    flat = normals()
    assert np.linalg.norm(flat, axis=1) == pytest.approx(1)
    assert flat[1] == pytest.approx(np.array([0, -1, 1]) / np.sqrt(2))  # of the first triangle
    assert flat[0] == pytest.approx(np.array([-1, -1, 2]) / np.sqrt(6))  # of both
    document["surfaces"][2]["rotate"] = turn
    assert normals()[1] == pytest.approx(np.array([0, -1, -1]) / np.sqrt(2), abs=1e-6)
    document["surfaces"][2]["shape"] = roof | {"normals": [[0, 0, 5]] * 4}
    assert normals() == pytest.approx(np.array([[0, -1, 0]] * 4), abs=1e-7)


def test_a_disc_and_a_box_face_outwards(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    disc = {"type": "disc", "centre": [1, 2, 3], "normal": [0, 3, 4], "radius": 2, "segments": 64}
    box = {"type": "box", "minimum": [0, 0, 0], "maximum": [1, 2, 3]}
    document["surfaces"][0]["shape"], document["surfaces"][2]["shape"] = disc, box
    scene = compiled(document)
    area = _areas(scene.surfaces[0].mesh, blobs).sum(axis=0)
    # The polygon's area, along the normal.
    assert area == pytest.approx(
        64 / 2 * np.sin(2 * np.pi / 64) * 4 * np.array([0, 0.6, 0.8]), rel=1e-5, abs=1e-5
    )
    mesh = scene.surfaces[2].mesh
    assert np.abs(_areas(mesh, blobs)).sum(axis=0) == pytest.approx([2 * 6, 2 * 3, 2 * 2])
    corners = _corners(mesh, blobs)
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(6)


def _corners(mesh: scene_pb2.Mesh, blobs: BlobStore) -> Any:
    blob = blobs.path(mesh.blob.hex()).read_bytes()
    vertices = np.frombuffer(blob, "<f4", 3 * mesh.vertex_count).reshape(-1, 3)
    return vertices[np.frombuffer(blob, "<u4")[-3 * mesh.triangle_count :].reshape(-1, 3)]


def _areas(mesh: scene_pb2.Mesh, blobs: BlobStore) -> Any:
    a, b, c = _corners(mesh, blobs).swapaxes(0, 1)
    return np.cross(b - a, c - a) / 2


def table(counts: tuple[int, int, int, int], *, basis: int = 0, extra: int = 0) -> bytes:
    head = struct.pack("<8s6I2f", b"NOCTBRDF", 1, *counts, basis, 400, 100)
    return head + bytes(4 * (int(np.prod(counts)) + 3 * basis) + extra)


def test_a_measured_table_is_passed_on(document: dict[str, Any], compiled: Compile, blobs: BlobStore) -> None:
    digest = blobs.put(table((2, 3, 4, 5)))
    kernel = {"type": "measured", "asset": f"sha256:{digest}", "format": "table"}
    document["surfaces"][0]["kernel"] = kernel
    scene = compiled(document)
    assert scene.kernels[scene.surfaces[0].kernel].measured.blob.hex() == digest


def test_a_merl_file_becomes_a_table(document: dict[str, Any], compiled: Compile, blobs: BlobStore) -> None:
    cells = 90 * 90 * 180
    data = struct.pack("<3i", 90, 90, 180) + np.repeat([1500.0, 3000, -1], cells).astype("<f8").tobytes()
    kernel = {"type": "measured", "asset": f"sha256:{blobs.put(data)}", "format": "merl"}
    document["surfaces"][0]["kernel"] = kernel
    scene = compiled(document)
    blob = blobs.path(scene.kernels[scene.surfaces[0].kernel].measured.blob.hex()).read_bytes()
    assert struct.unpack("<8s6I2f", blob[:40]) == (b"NOCTBRDF", 1, 90, 90, 180, 3, 81, 380, 5)
    numbers = np.frombuffer(blob, "<f4", offset=40)
    assert numbers[: 3 * 81].reshape(81, 3).sum(axis=1) == pytest.approx(1, abs=1e-6)
    values = numbers[3 * 81 :].reshape(3, cells)
    # The factors of the database's reading code.
    assert values[:, 0] == pytest.approx([1, 2 * 1.15, 0])


@pytest.mark.parametrize(
    ("data", "kind", "words"),
    [
        (b"", "table", "no table"),
        (b"", "merl", "0 bytes"),
        (table((2, 3, 4, 5), extra=1), "table", "its sizes say 520"),
        (table((2, 3, 4, 5))[:-4], "table", "its sizes say 520"),
        (
            struct.pack("<8s6I2f", b"NOCTBRDF", 1, 4096, 4096, 4096, 4096, 0, 400, 1),
            "table",
            "at most 67108864",
        ),
        (struct.pack("<8s6I2f", b"NOCTBRDF", 2, 1, 1, 1, 1, 0, 400, 1) + bytes(4), "table", "version 2"),
        (struct.pack("<8s6I2f", b"NOCTBRDF", 1, 1, 1, 1, 1, 0, 400, 0) + bytes(4), "table", "positive step"),
        (table((1, 1, 1, 2), basis=2), "table", "expected 3 planes"),
    ],
)
def test_a_wrong_table_is_refused(
    document: dict[str, Any], blobs: BlobStore, data: bytes, kind: str, words: str
) -> None:
    kernel = {"type": "measured", "asset": f"sha256:{blobs.put(data)}", "format": kind}
    document["surfaces"][0]["kernel"] = kernel
    expect_problem(document, blobs, "$.surfaces[0].kernel.asset", words)


@pytest.mark.parametrize(
    ("reflectance", "place", "words"),
    [
        ({"texture": "x"}, ".texture", 'no texture named "x"'),
        ({"texture": {"asset": "a.png"}}, ".texture.asset", "no paths"),
        ({"texture": {"asset": "a.png", "wrap": "mirror"}}, ".texture.wrap", '"repeat", "clamp"'),
        ({"texture": {"asset": "a.png"}, "spectrum": 2}, ".spectrum", "lies in [0, 1]"),
        ({"texture": {"asset": "a.png"}, "scale": [1, float("inf")]}, ".scale[1]", "finite"),
    ],
)
def test_a_wrong_texture_is_told(
    document: dict[str, Any], blobs: BlobStore, reflectance: Any, place: str, words: str
) -> None:
    document["surfaces"][1]["kernel"]["reflectance"] = reflectance
    expect_problem(document, blobs, f"$.surfaces[1].kernel.reflectance{place}", words)


def test_a_file_that_is_no_picture_is_told(document: dict[str, Any], blobs: BlobStore) -> None:
    use = {"texture": {"asset": f"sha256:{blobs.put(b'hello')}"}}
    document["surfaces"][1]["kernel"]["reflectance"] = use
    expect_problem(document, blobs, "$.surfaces[1].kernel.reflectance.texture.asset", "OpenImageIO")


def test_what_a_library_says_in_bytes_that_are_no_text_is_told() -> None:
    """As OpenImageIO repeats names of a damaged file."""
    assert said_by(lambda: b"no \xff".decode()) == "it has names that are no text"
    assert said_by(lambda: "/home/me/a.png: no PNG") == "the file: no PNG"


def test_photons_do_not_start_by_a_texture(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, picture: Any
) -> None:
    document["sensor"] = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 1, 0], "height": 1}
    document["surfaces"][1]["luminaire"]["radiance"] = {
        "texture": {"asset": picture(3)},
        "spectrum": {"illuminant": "D65", "luminance": 100},
    }
    assert compiled(document).luminaires[0].radiance.HasField("texture")
    document["tracing"] = {"direction": "forward"}
    expect_problem(document, blobs, "$.surfaces[1].luminaire.radiance", "can't start by a texture")
