"""Light of glTF's materials where they have two sides, or parts that are not there."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from numpy.typing import NDArray

from tests.pictures import read_pixels, write_picture
from tests.scene.formats.test_gltf_shapes import Model

HALF = np.array([[[0, 0, 0, 255], [0, 0, 0, 0]]], dtype=np.uint8)
"""Black, and on the right not there."""


def imported(tmp_path: Path, material: dict[str, Any], *pictures: NDArray[Any]) -> tuple[Any, Any, Path]:
    """Kernel and luminaire of a square of that material, and the folder of the document."""
    model = Model()
    model.mesh([0, 1, 2, 1, 3, 2], attributes={"TEXCOORD_0": model.array([[0, 1], [1, 1], [0, 0], [1, 0]])})
    model.tree["materials"] = [material]
    for number, picture in enumerate(pictures):
        write_picture(tmp_path / f"{number}.png", picture)
        model.tree.setdefault("images", []).append({"uri": f"{number}.png"})
        model.tree.setdefault("textures", []).append({"source": number})
    document, _ = model.imported(tmp_path, light="sky")
    [surface] = document["surfaces"]
    return document["kernels"][surface["kernel"]], surface.get("luminaire"), tmp_path / "out"


def amounts(folder: Path, use: Any) -> NDArray[np.float32]:
    """What a use of a linear picture is multiplied with, row by row."""
    assert use["texture"]["encoding"] == "linear"
    return read_pixels(folder / use["texture"]["asset"])


@pytest.mark.parametrize("double", [False, True])
def test_a_sheet_with_two_sides_emits_from_both(tmp_path: Path, double: bool) -> None:
    """https://github.com/LuxCoreRender/LuxCore/issues/503: from behind, 10 cd/m2, too, or nothing."""
    material = {
        "emissiveFactor": [1, 1, 1],
        "doubleSided": double,
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 10}},
    }
    _, luminaire, _ = imported(tmp_path, material)
    assert luminaire["radiance"]["luminance"] == pytest.approx(10)
    assert luminaire.get("two_sided", False) == double


def unlit(**pbr: Any) -> dict[str, Any]:
    return {"extensions": {"KHR_materials_unlit": {}}, "pbrMetallicRoughness": pbr}


# https://github.com/KhronosGroup/glTF-Sample-Viewer/issues/388 and /353,
# https://github.com/google/filament/issues/3459: before a sheet of 0.25 cd/m2 such a one of 1 cd/m2 has
# 0.25 where it is cut out, 0.625 where its alpha is a half.
@pytest.mark.parametrize(
    ("mode", "alpha", "shown"),
    [("MASK", 0.0, 0.0), ("BLEND", 0.0, 0.0), ("BLEND", 0.5, 0.5), ("MASK", 0.6, 1.0), ("OPAQUE", 0.5, 1.0)],
)
@pytest.mark.parametrize("lit", [False, True])
def test_what_is_not_there_emits_nothing(
    tmp_path: Path, mode: str, alpha: float, shown: float, lit: bool
) -> None:
    emitting = {
        "emissiveFactor": [1, 1, 1],
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, alpha]},
    }
    material = emitting if lit else unlit(baseColorFactor=[1, 1, 1, alpha])
    kernel, luminaire, _ = imported(tmp_path, {**material, "alphaMode": mode})
    assert (kernel["opacity"] if kernel["type"] == "mask" else 1.0) == shown
    found = 0.0 if luminaire is None else luminaire["radiance"]["luminance"]
    assert found == pytest.approx(shown)


@pytest.mark.parametrize("mode", ["MASK", "BLEND"])
def test_holes_of_a_picture_emit_nothing(tmp_path: Path, mode: str) -> None:
    material = {
        "emissiveFactor": [1, 1, 1],
        "alphaMode": mode,
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
    }
    kernel, luminaire, folder = imported(tmp_path, material, HALF)
    assert amounts(folder, kernel["opacity"])[0, :, 0].tolist() == [1, 0]
    radiance = luminaire["radiance"]
    assert amounts(folder, radiance)[0, :, 0].tolist() == [1, 0]
    assert radiance["spectrum"]["luminance"] == pytest.approx(1)


def test_holes_of_a_picture_are_in_the_picture_that_emits(tmp_path: Path) -> None:
    """A grey of 128 is 0.2159 by the sRGB curve; pictures may have different sizes."""
    material = {
        "emissiveFactor": [1, 1, 1],
        "alphaMode": "MASK",
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "emissiveTexture": {"index": 1},
    }
    glow = np.full((2, 4, 3), 128, dtype=np.uint8)
    _, luminaire, folder = imported(tmp_path, material, HALF, glow)
    found = amounts(folder, luminaire["radiance"])
    assert found[..., 0] == pytest.approx(np.array([[0.2159, 0.2159, 0, 0]] * 2), abs=1e-3)


def test_holes_elsewhere_than_the_picture_that_emits_are_said(tmp_path: Path) -> None:
    moved = {"KHR_texture_transform": {"offset": [0.5, 0]}}
    material = {
        "emissiveFactor": [1, 1, 1],
        "alphaMode": "MASK",
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "emissiveTexture": {"index": 1, "extensions": moved},
    }
    with pytest.raises(InputError, match="opacity by textures in different places"):
        imported(tmp_path, material, HALF, HALF)


def test_holes_of_an_unlit_picture(tmp_path: Path) -> None:
    white = HALF + np.array([255, 255, 255, 0], dtype=np.uint8)
    _, luminaire, folder = imported(
        tmp_path, {**unlit(baseColorTexture={"index": 0}), "alphaMode": "BLEND"}, white
    )
    assert amounts(folder, luminaire["radiance"])[0, :, 0].tolist() == [1, 0]


# https://github.com/PixarAnimationStudios/OpenUSD/issues/1796, https://github.com/bkaradzic/bimg/issues/142,
# https://github.com/google/filament/issues/2098: grey and alpha are the same as red, green, blue and alpha.
@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize("channels", [2, 4])
def test_pictures_of_grey_and_alpha(tmp_path: Path, channels: int, kind: Any) -> None:
    whole = np.iinfo(kind).max
    grey, alpha = round(128 / 255 * whole), round(51 / 255 * whole)
    picture = np.array([[[grey] * (channels - 1) + [alpha], [0] * (channels - 1) + [whole]]], dtype=kind)
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "alphaMode": "BLEND"}
    kernel, _, folder = imported(tmp_path, material, picture)
    assert amounts(folder, kernel["opacity"])[0, :, 0] == pytest.approx([0.2, 1], abs=1e-3)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_pictures_of_grey_alone_have_no_holes(tmp_path: Path, kind: Any) -> None:
    picture = np.zeros((1, 2, 1), dtype=kind)
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "alphaMode": "BLEND"}
    kernel, _, _ = imported(tmp_path, material, picture)
    assert kernel["type"] != "mask"


@pytest.mark.parametrize("place", ["file", "scene"])
def test_light_of_unknown_extensions_is_told(tmp_path: Path, place: str) -> None:
    """Such as EXT_lights_image_based, which a file uses and does not require."""
    model = Model()
    model.mesh([0, 1, 2])
    at = model.tree if place == "file" else model.tree["scenes"][0]
    at["extensions"] = {"EXT_lights_image_based": {"light": 0}}
    with pytest.raises(InputError, match="EXT_lights_image_based; its light is left out"):
        model.imported(tmp_path)
