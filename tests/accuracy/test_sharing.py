"""Pixels that reuse their neighbours' paths make the same image as pixels alone.

Each scene is traced with many seeds by both methods. Neighbours are not independent of each other, so errors
come from the scatter among the seeds: Student's t of 8 x 8 tiles and of the mean. Seeds are fixed; false
alarms: 0.01 + 0.003 for each scene.
"""

import json
import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_client.local.compiled import compile_to
from nocturne_scene.validation.documents import box, diffuse, quad, sphere, surface
from scipy import stats

from tests.accuracy.cameras_both_ways import SCENES as OPEN_SCENES
from tests.accuracy.scenes import cornell
from tests.accuracy.tracing import IN_FULL, Document, part_of, run_seeds, write
from tests.pictures import write_exr

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_EDGE = 24
_SAMPLES = 64
_SEEDS = 24 if IN_FULL else 12
_MANY = 1024 if IN_FULL else 8192
"""With all pixels and seeds 14 million."""
_TILE = 8
_SPHERES: dict[str, Document] = {
    "mirror": {"type": "conductor", "index": "Ag"},
    "rough metal": {"type": "conductor", "index": "Cu", "roughness": 0.15},
    "glass": {"type": "dielectric", "index": 1.5, "absorption": 0.5},
    "dispersion": {"type": "dielectric", "index": "N-SF11", "roughness": 0.1},
    "coated": {"type": "coated_diffuse", "reflectance": 0.6, "index": 1.5},
    "transmitter": {"type": "diffuse_transmitter", "reflectance": 0.3, "transmittance": 0.5},
    "mask": {"type": "mask", "kernel": {"type": "lambertian", "reflectance": 0.7}, "opacity": 0.5},
}


def room(*inside: Document, wall: Callable[[float], Document] = diffuse, **further: Any) -> Document:
    """Walls of different albedos, open in front, a lamp below the ceiling."""
    walls = [
        (quad([-1, 0, -1], [0, 0, 2], [2, 0, 0]), 0.7),
        (quad([-1, 2, -1], [2, 0, 0], [0, 0, 2]), 0.8),
        (quad([-1, 0, -1], [2, 0, 0], [0, 2, 0]), 0.6),
        (quad([-1, 0, -1], [0, 2, 0], [0, 0, 2]), 0.2),
        (quad([1, 0, -1], [0, 0, 2], [0, 2, 0]), 0.5),
    ]
    lamp = surface(quad([-0.4, 1.9, -0.4], [0.8, 0, 0], [0, 0, 0.8]), diffuse(0.3), 5.0)
    camera = {
        "type": "pinhole",
        "position": [0.1, 1.0, 3.4],
        "look_at": [0, 0.9, 0],
        "vertical_field_of_view_degrees": 38,
    }
    surfaces = [*(surface(shape, wall(albedo)) for shape, albedo in walls), lamp, *inside]
    return {"nocturne": 1, "sensor": camera, "surfaces": surfaces, **further}


def _with_sphere(kernel: str) -> Document:
    return room(surface(sphere([0.2, 0.55, 0.1], 0.5), _SPHERES[kernel]))


def _varnished(albedo: float) -> Document:
    return {"type": "coated_diffuse", "reflectance": albedo, "index": 1.5, "roughness": 0.3}


def _lacquered(albedo: float) -> Document:
    return {"type": "coated_diffuse", "reflectance": albedo, "index": 1.5}


def _principled(albedo: float) -> Document:
    return {"type": "principled", "base": albedo, "metallic": 0.2, "roughness": 0.6, "coat": 0.5}


def _cloth(albedo: float) -> Document:
    return {"type": "diffuse_transmitter", "reflectance": albedo, "transmittance": 0.8 - albedo}


def _half_mirror(albedo: float) -> Document:
    metal = {"type": "conductor", "index": "Al", "roughness": 0.2}
    return {"type": "blend", "first": metal, "second": diffuse(albedo), "weight": 0.6}


def _wallpapered() -> Document:
    """Walls of checks and a ball with grooves finer than a block of pixels."""

    def paper(albedo: float) -> Document:
        return {
            "type": "lambertian",
            "reflectance": {"texture": "paper", "spectrum": albedo, "scale": [6, 6]},
        }

    grooves = {"texture": "grooves", "scale": [24, 12], "height": 0.01}
    ball = surface(sphere([0.2, 0.55, 0.1], 0.5), diffuse(0.7)) | {"bump_map": grooves}
    textures = {"paper": {"asset": "paper.exr"}, "grooves": {"asset": "grooves.exr"}}
    return room(ball, wall=paper, textures=textures)


def _write_pictures(folder: Path) -> None:
    """What `_wallpapered` names."""
    checks = np.kron([[0.2, 0.9], [1.0, 0.4]], np.ones((4, 4)))
    ridge = 1.0 - np.abs(np.linspace(-1.0, 1.0, 16))
    write_exr(folder / "paper.exr", checks[..., None].astype(np.float32), "Y")
    write_exr(folder / "grooves.exr", np.tile(ridge, (4, 1))[..., None].astype(np.float32), "Y")


def _thin_walls() -> Document:
    """A wall of 2 mm and a slab of glass before the back wall, whose sides are close together."""
    wall = surface(box([-0.5, 0, -0.3], [0.3, 1.2, -0.298]), diffuse(0.6))
    pane = surface(box([-0.2, 0.3, 0.4], [0.6, 1.0, 0.400001]), _SPHERES["glass"])
    return room(wall, pane)


def _instances() -> Document:
    block = surface(box([-0.15, 0, -0.15], [0.15, 0.5, 0.15]), diffuse(0.6))
    places = [[-0.6, 0, -0.5], [-0.1, 0, 0.2], [0.5, 0, -0.3], [0.4, 0, 0.5]]
    shown = [{"group": "block", "translate": place} for place in places]
    return room(groups={"block": [block]}, instances=shown)


def _moving() -> Document:
    ball = surface(sphere([-0.3, 0.4, 0], 0.35), diffuse(0.7))
    return room(ball | {"motion": {"translate": [0.6, 0.2, 0]}})


def _smoke_in_front() -> Document:
    """A box of thin smoke between the camera and the walls: photons reach these weakened."""
    smoke = {"shape": box([-0.99, 0.01, 0.7], [0.99, 1.99, 0.95]), "interior": {"media": ["smoke"]}}
    thin = {"absorption": {"table": [[400, 3.0], [700, 0.4]]}}
    return room(smoke, media={"smoke": thin})


SCENES: dict[str, Callable[[], Document]] = {
    "cornell": lambda: cornell({}),
    **{name: partial(_with_sphere, name) for name in _SPHERES},
    "varnished walls": lambda: room(wall=_varnished),
    "lacquered walls": lambda: room(wall=_lacquered),
    "principled walls": lambda: room(wall=_principled),
    "walls of cloth": lambda: room(wall=_cloth),
    "half mirrors": lambda: room(wall=_half_mirror),
    "thin walls": _thin_walls,
    "textures and bumps": _wallpapered,
    "instances": _instances,
    "motion": _moving,
    "lens": lambda: OPEN_SCENES["ball, lens"].document,
    "smoke in front": _smoke_in_front,
}


def tiles(
    document: Document, folder: Path, samples: int = _SAMPLES, **tracing: Any
) -> npt.NDArray[np.float64]:
    """Y of each seed's tiles, (seeds, tiles); the scene is traced by the method in `tracing`."""
    folder.mkdir()
    if "textures" in document:
        _write_pictures(folder)
    traced = json.loads(json.dumps(document))
    traced["tracing"] = traced.get("tracing", {}) | {"photons_together": 4} | tracing
    compiled = compile_to(write(traced, folder), folder, _EDGE, _EDGE, part_of(samples))
    images = [image.xyz[..., 1] for image, _ in run_seeds(compiled, folder, _SEEDS)]
    count = _EDGE // _TILE
    means = np.stack(images).reshape(_SEEDS, count, _TILE, count, _TILE).mean((2, 4))
    return np.asarray(means.reshape(_SEEDS, -1))


def differ(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64], alpha: float) -> bool:
    """Whether any column's means do; Student's t of pairs with the same seed, Sidak's bound."""
    p = stats.ttest_rel(a, b, axis=0).pvalue
    return bool(np.min(p) < 1.0 - (1.0 - alpha) ** (1.0 / a.shape[1]))


@pytest.mark.parametrize("name", SCENES)
def test_shared_images_are_those_of_pixels_alone(name: str, tmp_path: Path) -> None:
    document = SCENES[name]()
    alone, shared = (tiles(document, tmp_path / f"{pixels}", sharing=pixels) for pixels in (1, 16))
    assert not differ(alone, shared, 0.01)
    assert not differ(alone.mean(1, keepdims=True), shared.mean(1, keepdims=True), 0.003)


_OF_ALL_KINDS = (
    "mirror",
    "glass",
    "thin walls",
    "mask",
    "coated",
    "textures and bumps",
    "instances",
    "motion",
    "dispersion",
    "cornell",
)


@pytest.mark.soak
@pytest.mark.parametrize("name", _OF_ALL_KINDS)
def test_means_of_ten_million_samples_are_equal_to_a_thousandth(name: str, tmp_path: Path) -> None:
    """Of all pixels and seeds. The standard error of the difference is some 2e-4; false alarms: 1e-6."""
    alone, shared = (
        tiles(SCENES[name](), tmp_path / f"{pixels}", _MANY, sharing=pixels).mean(axis=1)
        for pixels in (1, 16)
    )
    off = (shared - alone) / alone.mean()
    assert off.std(ddof=1) / math.sqrt(_SEEDS) < 3e-4
    assert abs(off.mean()) < 1e-3


def test_sharing_is_seen_by_these_statistics(tmp_path: Path) -> None:
    """What a lamp 2 % brighter makes of the same scene is found."""
    alone = tiles(room(), tmp_path / "alone", sharing=1)
    shared = tiles(room(), tmp_path / "shared", sharing=16) * 1.02
    assert differ(alone, shared, 0.01)


def test_both_directions_share_what_is_theirs(tmp_path: Path) -> None:
    document = OPEN_SCENES["bowl"].document
    alone = tiles(document, tmp_path / "alone", direction="both", sharing=1)
    shared = tiles(document, tmp_path / "shared", direction="both", sharing=16)
    assert not differ(alone, shared, 0.01)
