"""What a scene says that can hardly be meant."""

import json
import math
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import fine_textures
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import parse_document
from nocturne_scene.film import Film
from nocturne_scene.textures import pictures
from nocturne_scene.validation.documents import furnace

from tests.pictures import write_exr

GLASS = {"type": "dielectric", "index": 1.5}
TETRAHEDRON = {
    "type": "mesh",
    "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
}
OPEN = {**TETRAHEDRON, "triangles": TETRAHEDRON["triangles"][:3]}


def warnings(document: dict[str, Any], blobs: BlobStore, film: Film | None = None) -> list[str]:
    return [
        each.sentence for each in compile_scene(parse_document(json.dumps(document)), blobs, film).warnings
    ]


def test_a_scene_without_fault_has_no_warning(document: dict[str, Any], blobs: BlobStore) -> None:
    assert warnings(document, blobs) == []


@pytest.mark.parametrize(
    "shape",
    [
        TETRAHEDRON,
        {"type": "sphere", "centre": [0, 0, 0], "radius": 1},
        {"type": "box", "minimum": [0, 0, 0], "maximum": [1, 1, 1]},
    ],
)
def test_a_closed_body_of_glass_is_right(
    document: dict[str, Any], blobs: BlobStore, shape: dict[str, Any]
) -> None:
    document["surfaces"].append({"shape": shape, "kernel": GLASS})
    assert warnings(document, blobs) == []


@pytest.mark.parametrize(
    ("shape", "edges"),
    [(OPEN, 3), ({"type": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}, 4)],
)
def test_an_open_body_of_glass_is_told(
    document: dict[str, Any], blobs: BlobStore, shape: dict[str, Any], edges: int
) -> None:
    document["surfaces"].append({"shape": shape, "kernel": GLASS})
    [told] = warnings(document, blobs)
    place = f"$.surfaces[{len(document['surfaces']) - 1}].shape: "
    assert told.startswith(f"{place}bounds a body, and is open: {edges} edges")


def test_an_open_body_in_a_group_is_told(document: dict[str, Any], blobs: BlobStore) -> None:
    document["groups"] = {"glasses": [{"shape": OPEN, "kernel": GLASS}]}
    document["instances"] = [{"group": "glasses"}]
    [told] = warnings(document, blobs)
    assert told.startswith("$.groups.glasses[0].shape: bounds a body, and is open")


def test_surfaces_close_a_body_together(document: dict[str, Any], blobs: BlobStore) -> None:
    for triangle in TETRAHEDRON["triangles"]:
        shape = {**TETRAHEDRON, "triangles": [triangle]}
        document["surfaces"].append({"shape": shape, "kernel": GLASS})
    assert warnings(document, blobs) == []
    document["surfaces"].pop()
    assert "together with 2 other surfaces" in warnings(document, blobs)[0]


def test_a_mixture_that_loses_light_is_told(document: dict[str, Any], blobs: BlobStore) -> None:
    document["tracing"] = {"mixture": {"kernel": 0, "luminaires": 1}}
    [told] = warnings(document, blobs)
    assert told.startswith("$.tracing.mixture: neither kernel nor uniform")
    document["tracing"]["mixture"]["uniform"] = 0.1
    assert warnings(document, blobs) == []


# --- bodies that cross each other ---

WATER = {"type": "dielectric", "index": 1.33}


def ball(x: float, radius: float = 1.0) -> dict[str, Any]:
    return {"type": "sphere", "centre": [x, 10, 0], "radius": radius}


def block(low: list[float], high: list[float]) -> dict[str, Any]:
    return {"type": "box", "minimum": low, "maximum": high}


@pytest.mark.parametrize(
    ("one", "other", "said"),
    [
        (ball(0), ball(1.5), "[1] crosses the body of [0]"),
        (ball(0), ball(3), None),
        (ball(0), ball(0.2, 0.5), "[1] is inside of the body of [0]"),  # a drop within
        (ball(0.2, 0.5), ball(0), "[0] is inside of the body of [1]"),
        (block([0, 8, 0], [1, 9, 1]), block([0.5, 8.5, 0.5], [2, 9.5, 2]), "[1] crosses the body of [0]"),
        (block([0, 8, 0], [1, 9, 1]), block([1, 8, 0], [2, 9, 1]), None),  # they touch
        (block([0, 8, 0], [3, 11, 3]), block([1, 9, 1], [2, 10, 2]), "[1] is inside of the body of [0]"),
        (block([-3, 9, -3], [3, 9.5, 3]), ball(0), "[1] crosses the body of [0]"),
    ],
)
def test_bodies_of_one_priority_in_one_place_are_told(
    document: dict[str, Any], blobs: BlobStore, one: dict[str, Any], other: dict[str, Any], said: str | None
) -> None:
    first = len(document["surfaces"])
    document["surfaces"] += [{"shape": one, "kernel": GLASS}, {"shape": other, "kernel": WATER}]
    told = [each.replace(".shape:", "") for each in warnings(document, blobs)]
    for number in (0, 1):
        told = [each.replace(f"$.surfaces[{first + number}]", f"[{number}]") for each in told]
    assert [each.partition(",")[0] for each in told] == ([said] if said else [])
    # It is said which of them is there; and of one kind of glass they are one body.
    document["surfaces"][first + 1]["kernel"] = {**WATER, "priority": 1}
    assert warnings(document, blobs) == []
    document["surfaces"][first + 1]["kernel"] = GLASS
    assert warnings(document, blobs) == []


SHEET = {"type": "disc", "centre": [0, 10, 0], "normal": [0, 1, 0], "radius": 1}


@pytest.mark.parametrize("shape", [ball(0.2, 0.5), SHEET])
def test_boundaries_between_two_indices_are_no_bodies(
    document: dict[str, Any], blobs: BlobStore, shape: dict[str, Any]
) -> None:
    """They may be open, and anywhere."""
    document["surfaces"] += [
        {"shape": ball(0), "kernel": GLASS},
        {"shape": shape, "kernel": {**WATER, "outside": 1.5}},
    ]
    assert warnings(document, blobs) == []


# --- rooms at the limit of interactions ---


def room(albedo: float, depth: int | None) -> dict[str, Any]:
    document = furnace(albedo, 1.0)
    document["tracing"] = {} if depth is None else {"maximum_depth": depth}
    return document


def test_a_closed_room_at_the_limit_of_interactions_is_told(blobs: BlobStore) -> None:
    """The missing part is the albedo to the power of one more than the limit."""
    [told] = warnings(room(0.9, 20), blobs)
    assert told.startswith(
        "$.tracing.maximum_depth: the sensor is in a closed room that reflects up to 90.0%"
    )
    assert "up to 0.11 of it" in told
    assert warnings(room(0.9, None), blobs) == []
    assert warnings(room(0.9, 80), blobs) == []
    assert warnings(room(0.0, 1), blobs) == []


def test_a_room_with_a_window_is_not_told(blobs: BlobStore) -> None:
    document = room(0.9, 20)
    del document["surfaces"][0]
    assert warnings(document, blobs) == []


def test_a_sphere_around_the_sensor_is_a_room(blobs: BlobStore) -> None:
    document = room(0.9, 20)
    document["surfaces"] = [
        {**document["surfaces"][0], "shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 3}}
    ]
    assert len(warnings(document, blobs)) == 1
    document["sensor"]["position"] = [5, 0, 0]
    assert warnings(document, blobs) == []


# --- textures finer than the film can see ---


def test_a_texture_finer_than_the_film_is_told(
    document: dict[str, Any], blobs: BlobStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The quad's edge of 1 m has 64 texels of 1/64 m. At a distance of z a pixel of a film with h rows, 40
    degrees high, sees 0.73 z / h."""
    picture = blobs.put(write_exr(tmp_path / "a.exr", np.ones((64, 64, 3)), "RGB").read_bytes())
    texture: dict[str, Any] = {"texture": {"asset": f"sha256:{picture}"}}
    document["surfaces"][1] |= {
        "shape": {"type": "quad", "corner": [0, 0, 10], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]},
        "kernel": {"type": "lambertian", "reflectance": texture},
    }
    opened = MagicMock(wraps=pictures.opened)
    monkeypatch.setattr(fine_textures, "opened", opened)
    document["surfaces"] += 3 * [document["surfaces"][1]]
    [told] = [each for each in warnings(document, blobs, Film(40, 40, 1)) if "texels" in each]
    assert told.startswith("$.surfaces[1]: its texture")
    assert told.endswith("the same is true of 3 others, numbers apart")
    assert opened.call_count == 1
    del document["surfaces"][2:]
    [told] = warnings(document, blobs, Film(40, 40, 1))
    # 12 m away: 0.2184 m, 13.98 texels.
    assert told.startswith("$.surfaces[1]: its texture of 64 x 64 texels has 14 of them along a pixel's edge")
    assert warnings(document, blobs, Film(80, 80, 1)) == []
    assert warnings(document, blobs) == []
    texture["scale"] = [2, 2]
    assert "has 14 of them" in warnings(document, blobs, Film(80, 80, 1))[0]


def test_a_camera_on_a_sphere_is_told(document: dict[str, Any], blobs: BlobStore) -> None:
    """A clear ball in even light of 1 shows 2.25 from inside and 1 from outside; from its surface 2.07."""
    x, y, z = document["sensor"]["position"]
    ball = {"shape": {"type": "sphere", "centre": [x, y, z + 0.25], "radius": 0.25}, "kernel": GLASS}
    document["surfaces"].append(ball)
    [told] = [each for each in warnings(document, blobs) if each.startswith("$.sensor.position: lies on")]
    assert f"of $.surfaces[{len(document['surfaces']) - 1}]" in told
    ball["shape"]["radius"] = 0.25001
    assert not [each for each in warnings(document, blobs) if "lies on the sphere" in each]


def test_what_moves_too_far_for_its_size_is_told(document: dict[str, Any], blobs: BlobStore) -> None:
    for distance, told in ((1e4, 0), (1e6, 1)):
        document["surfaces"].append({"shape": TETRAHEDRON, "motion": {"translate": [distance, 0, 0]}})
        document["surfaces"][-1]["kernel"] = {"type": "lambertian", "reflectance": 0.5}
        found = [each for each in warnings(document, blobs) if ".motion: moves 1 m" in each]
        assert len(found) == told


def test_opaque_surfaces_in_one_place_are_told(document: dict[str, Any], blobs: BlobStore) -> None:
    """Turned over or not; a null kernel there is no matter."""
    quad = {"type": "quad", "corner": [0, 0, 9], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}
    turned = quad | {"edge_u": quad["edge_v"], "edge_v": quad["edge_u"]}
    grey = {"type": "lambertian", "reflectance": 0.5}
    document["surfaces"].append({"shape": quad, "kernel": grey})
    document["surfaces"].append({"shape": quad, "kernel": {"type": "null"}, "luminaire": {"radiance": 1.0}})
    assert warnings(document, blobs) == []
    document["surfaces"].append({"shape": turned, "kernel": grey})
    count = len(document["surfaces"])
    [told] = warnings(document, blobs)
    assert told.startswith(f"$.surfaces[{count - 1}]: lies exactly on $.surfaces[{count - 3}]")


def test_normals_far_off_their_triangles_are_told(document: dict[str, Any], blobs: BlobStore) -> None:
    """A pyramid's corners have normals between its faces'."""
    document["surfaces"].append(
        {"shape": TETRAHEDRON, "kernel": {"type": "lambertian", "reflectance": 0.5}},
    )
    assert warnings(document, blobs) == []
    document["surfaces"][-1]["shape"] = TETRAHEDRON | {"smooth": True}
    [told] = warnings(document, blobs)
    assert "interpolated normals are" in told


def test_a_map_that_is_bright_at_a_pole_is_told(
    document: dict[str, Any], blobs: BlobStore, tmp_path: Path
) -> None:
    """An even map loses nothing. Of the first row alone, which ends at the cosine of pi / 16, the same flux
    fills texels that end at 7 / 8: on a surface that faces the pole it counts by the mean cosine.
    """
    for rest, told in ((1.0, 0), (0.0, 1)):
        picture = np.full((16, 32, 3), rest, np.float32)
        picture[0] = 1.0
        digest = blobs.put(write_exr(tmp_path / "sky.exr", picture, "RGB").read_bytes())
        document["environment"] = {"asset": f"sha256:{digest}", "luminance": 100.0}
        found = [each for each in warnings(document, blobs) if "at a pole" in each]
        assert len(found) == told
    assert f"{1 - 1.875 / (1 + math.cos(math.pi / 16)):.2%}" in found[0]


# --- light behind flat lamps ---

BOTH_WAYS = b"""IESNA:LM-63-2002
TILT=NONE
1 -1 1 4 1 1 2 0 0 0
1 1 0
0 89.999 90.001 180
0
100 100 50 50
"""
LAMPS: dict[str, dict[str, Any]] = {
    "quad": {"type": "quad", "corner": [0, 0, 0], "edge_u": [0.1, 0, 0], "edge_v": [0, 0, 0.1]},
    "disc": {"type": "disc", "centre": [0, 0, 0], "normal": [0, -1, 0], "radius": 0.1},
    "mesh": {
        "type": "mesh",
        "vertices": [[0, 0, 0], [0.1, 0, 0], [0, 0, 0.1], [0.1, 0, 0.1]],
        "triangles": [[0, 1, 2], [1, 3, 2]],
    },
    "ball": {"type": "sphere", "centre": [0, 0, 0], "radius": 0.1},
}


def lamp(
    document: dict[str, Any], blobs: BlobStore, shape: dict[str, Any], content: bytes = BOTH_WAYS, **more: Any
) -> list[str]:
    profile = {"asset": f"sha256:{blobs.put(content)}", **more.pop("profile", {})}
    luminaire = {"radiance": {"illuminant": "A", "luminance": 1}, "profile": profile, **more}
    document["surfaces"].append({"shape": shape, "kernel": {"type": "null"}, "luminaire": luminaire})
    return warnings(document, blobs)


@pytest.mark.parametrize("kind", ["quad", "disc", "mesh"])
def test_light_that_a_flat_lamp_blocks_is_told(document: dict[str, Any], blobs: BlobStore, kind: str) -> None:
    """https://github.com/LuxCoreRender/LuxCore/issues/94: of 100 cd down and 50 cd up the latter are lost,
    2 pi 50 lm, or of 1000 lm a third.
    """
    [told] = lamp(document, blobs, LAMPS[kind])
    place = f"$.surfaces[{len(document['surfaces']) - 1}].luminaire.profile"
    assert told.startswith(f"{place}: of the file's 942.5 lm, 314.2 lm go to the back of the surface")
    document["surfaces"].pop()
    [told] = lamp(document, blobs, LAMPS[kind], profile={"lumens": 1000})
    assert "of the file's 1000 lm, 333.3 lm go to the back" in told


def test_light_to_one_side_by_the_file_is_told_where_the_lamp_faces_the_other(
    document: dict[str, Any], blobs: BlobStore
) -> None:
    down = BOTH_WAYS.replace(b"100 100 50 50", b"100 100 0 0")
    assert lamp(document, blobs, LAMPS["disc"], down) == []
    document["surfaces"].pop()
    [told] = lamp(document, blobs, {**LAMPS["disc"], "normal": [0, 1, 0]}, down)
    assert "of the file's 628.3 lm, 628.3 lm go to the back" in told


def test_light_to_one_side_about_the_axis_is_told(document: dict[str, Any], blobs: BlobStore) -> None:
    """All of the light within 90 degrees of horizontal angle 0, on a lamp that faces angle 180 of it."""
    aside = BOTH_WAYS.replace(b" 4 1 1 2 ", b" 2 4 1 2 ").replace(
        b"0 89.999 90.001 180\n0\n", b"0 180\n0 89.999 90.001 180\n"
    )
    aside = aside.replace(b"100 100 50 50", b"1 1 1 1 0 0 0 0")
    wall = {**LAMPS["disc"], "normal": [1, 0, 0]}
    assert lamp(document, blobs, wall, aside, profile={"zero": [1, 0, 0]}) == []
    document["surfaces"].pop()
    [told] = lamp(document, blobs, wall, aside, profile={"zero": [-1, 0, 0]})
    assert "lm go to the back" in told


def test_lamps_that_emit_to_both_sides_lose_nothing(document: dict[str, Any], blobs: BlobStore) -> None:
    assert lamp(document, blobs, LAMPS["ball"]) == []
    document["surfaces"].pop()
    assert lamp(document, blobs, LAMPS["quad"], two_sided=True) == []
