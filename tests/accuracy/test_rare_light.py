"""Light that photons meet too rarely for a pilot to learn where it comes from."""

import json
from math import radians, tan
from pathlib import Path

import numpy as np
import pytest
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_scene.compile.unmet import unmet_light
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.render_warnings import RenderWarning
from nocturne_scene.validation.documents import diffuse, quad, sphere, surface
from numpy.typing import NDArray

from tests.accuracy.tracing import Document
from tests.pictures import write_exr

GLASS_BALL = Path(__file__).parents[2] / "examples" / "pbrt" / "glass_ball.pbrt"


@pytest.mark.parametrize("samples", [2, 16, 128])
def test_a_ball_of_glass_on_a_wide_floor_is_found_by_what_may_gather_light(
    samples: int, tmp_path: Path
) -> None:
    """Under an even sky and a Sun, one photon of 800 that leave for a floor of 40 m meets the ball of 1 m. By
    photons from the sensor alone this film's mean is 363.7 cd/m2 and 128 samples say +- 0.1; 365.4 is true.
    """
    document = import_scene(GLASS_BALL, tmp_path / "scene", ImportOptions()).document
    compiled = compile_to(document, tmp_path, 320, 320, samples)
    assert compiled.way.startswith("photons from both directions"), compiled.way


def test_light_that_a_pilot_hardly_met_is_told() -> None:
    assert unmet_light(0.0) is None
    assert unmet_light(0.0049) is None
    for told, direction in ((unmet_light(0.024), "both"), (unmet_light(0.024, "forward"), "forward")):
        assert told is not None
        assert "up to 2.4% of the mean may be missing" in told.sentence
        assert f'`"direction": "{direction}"` would find it' in told.sentence


def test_a_pilot_that_sees_nothing_says_where_light_may_be_missing(tmp_path: Path) -> None:
    """A meter 1 m under water in the Sun: refraction turns its disc away from where photons are aimed."""
    water = surface(
        {"type": "box", "minimum": [-90, -90, -3], "maximum": [90, 90, 0]},
        {"type": "dielectric", "index": 1.33},
    )
    meter = {"type": "irradiance_meter", "position": [0, 0, -1], "normal": [0, 0, 1], "height": 0.1}
    document = {
        "nocturne": 1,
        "sensor": meter,
        "surfaces": [water],
        "distant": [{"direction": [0.8660254037844386, 0, 0.5], "irradiance": 1}],
    }
    (tmp_path / "scene.json").write_text(json.dumps(document))
    compiled = compile_to(tmp_path / "scene.json", tmp_path, 8, 6, 256)
    assert "failed" not in compiled.way
    [told] = [each.sentence for each in compiled.warnings if "small bright light sources" in each.sentence]
    assert "any number of times the light shown there" in told


SILVER: dict[str, object] = {"type": "conductor", "index": "Ag"}
_TALL, _EDGE = 40.0, 64
"""Field of view, degrees; edge of the film, pixels."""


def _seen_in_a_mirror(
    radius: float, radiance: float, kernel: Document, folder: Path, around: Document | None = None
) -> tuple[RenderWarning, ...]:
    """The warnings for an image of a mirror 3 m in front of the camera, which shows a lamp behind the
    camera."""
    document: Document = {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0, 0, -2],
            "look_at": [0, 0, 0],
            "up": [0, 1, 0],
            "vertical_field_of_view_degrees": _TALL,
        },
        "environment": {"radiance": 0.05},
        "surfaces": [
            surface(quad([-5, -5, 1], [0, 10, 0], [10, 0, 0]), kernel),
            surface(sphere([0.9, 0.6, -3], radius), diffuse(0.0), radiance),
        ],
    }
    document["surfaces"] += [{"shape": _AROUND} | around] if around else []
    document["media"] = _MEDIA
    (folder / "scene.json").write_text(json.dumps(document))
    return compile_to(folder / "scene.json", folder, _EDGE, _EDGE, 16).warnings


def _named(said: tuple[RenderWarning, ...]) -> NDArray[np.bool_]:
    """Pixels in which light may be missing."""
    named = np.zeros((_EDGE, _EDGE), dtype=np.bool_)
    for part in (part for warning in said for part in warning.parts):
        named[part.pixels] = True
    return named


_LAMP_AT = (
    int(0.5 * _EDGE * (1.0 - 0.6 / 7.0 / tan(radians(_TALL / 2.0)))),
    int(0.5 * _EDGE * (1.0 - 0.9 / 7.0 / tan(radians(_TALL / 2.0)))),
)
"""Row and column: its image in the mirror is 7 m off, 0.9 m to a side and 0.6 m up."""

MASK: Document = {"kernel": {"type": "mask", "kernel": diffuse(0.3), "opacity": 0.2}}
HAZE: Document = {"interior": {"media": ["haze"]}}
_MEDIA: Document = {"haze": {"scattering": 0.02}}
"""What lets light through by chance."""
_AROUND: Document = {"type": "box", "minimum": [-6, -6, -1], "maximum": [6, 6, 2]}
"""The mirror alone."""


PHONG: Document = {"type": "phong", "reflectance": 0.9}
"""With an exponent from 20 on it gathers, too, and nothing else in the scene need."""


@pytest.mark.parametrize("kernel", [SILVER, PHONG | {"exponent": 1e6}], ids=["silver", "phong"])
def test_a_lamp_of_a_millimetre_in_a_mirror_is_named_where_it_shows(kernel: Document, tmp_path: Path) -> None:
    """Its image is 7 m off, 0.9 m to a side and 0.6 m up: one photon of 8,000 of that pixel meets it."""
    said = _seen_in_a_mirror(5e-4, 1e7, kernel, tmp_path)
    named = _named(said)
    assert named[_LAMP_AT], said
    assert named.mean() < 0.3, said


@pytest.mark.parametrize("around", [MASK, HAZE], ids=["mask", "haze"])
def test_a_mirror_in_what_lets_light_through_by_chance_hides_no_lamp(
    around: Document, tmp_path: Path
) -> None:
    """The edges of the box are close together, so that photons start on its faces themselves."""
    named = _named(_seen_in_a_mirror(5e-4, 1e7, SILVER, tmp_path, around))
    assert named[_LAMP_AT]
    assert named.mean() < 0.3


def test_nothing_is_named_where_a_lamp_is_met(tmp_path: Path) -> None:
    """A lamp of 0.8 m, and a wall that mirrors nothing."""
    assert not _seen_in_a_mirror(0.4, 20.0, SILVER, tmp_path)
    assert not _seen_in_a_mirror(5e-4, 1e7, diffuse(0.5), tmp_path)
    assert not _seen_in_a_mirror(5e-4, 1e7, PHONG | {"exponent": 19.0}, tmp_path)


def _thrown_to_a_floor(kernel: Document, folder: Path) -> CompiledFolder:
    """A mirror that leans over a floor, and a lamp of 2 mm, both of whose light comes to the camera."""
    document: Document = {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0, 2.5, -3],
            "look_at": [0, 0, 0],
            "vertical_field_of_view_degrees": _TALL,
        },
        "environment": {"radiance": 0.05},
        "surfaces": [
            surface(quad([-2, 0, -2], [0, 0, 4], [4, 0, 0]), diffuse(0.5)),
            surface(quad([-0.4, 0.05, 0.5], [0, 0.6, 0.4], [0.8, 0, 0]), kernel),
            surface(sphere([0.3, 1.6, -0.5], 1e-3), diffuse(0.0), 1e7),
        ],
    }
    folder.mkdir(exist_ok=True)
    (folder / "scene.json").write_text(json.dumps(document))
    return compile_to(folder / "scene.json", folder, _EDGE, _EDGE, 16)


def _picture(values: list[float], folder: Path) -> Document:
    """As a value that varies: columns of these numbers."""
    folder.mkdir(exist_ok=True)
    write_exr(folder / "picture.exr", np.tile(np.array(values, np.float32)[:, None], (8, 1, 1)), "Y")
    return {"texture": {"asset": "picture.exr"}}


_METAL: Document = {"type": "principled", "metallic": 1.0, "base": 0.95}
"""Its roughness is the root of a microfacet's."""


@pytest.mark.parametrize(
    ("kernel", "name", "smooth", "rough"),
    [(SILVER, "roughness", 0.01, 0.5), (_METAL, "roughness", 0.1, 0.7)],
    ids=["conductor", "principled"],
)
def test_a_roughness_that_is_a_picture_gathers_where_it_is_smooth(
    kernel: Document, name: str, smooth: float, rough: float, tmp_path: Path
) -> None:
    """A picture of one number is that number, but for the pilot's chance; one of smooth parts gathers as
    well; a rough one does not."""

    def named_of(values: list[float]) -> NDArray[np.bool_]:
        folder = tmp_path / f"{values}"
        varies = kernel | {name: _picture(values, folder) if len(values) > 1 else values[0]}
        return _named(_thrown_to_a_floor(varies, folder).warnings)

    by_number, by_picture = named_of([smooth]), named_of([smooth] * 4)
    assert by_number.any()
    assert (by_number & by_picture).sum() > 0.5 * (by_number | by_picture).sum()
    assert named_of([smooth, smooth, rough, rough]).any()
    assert not named_of([rough]).any()
    assert not named_of([rough] * 4).any()


def _mirrored_on_a_ball(
    radius: float, eye: NDArray[np.float64], lamp: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The point at which a ball around the origin mirrors a lamp: the shortest path via its surface
    (Fermat)."""
    best = (eye / np.linalg.norm(eye) + lamp / np.linalg.norm(lamp)) / 2.0
    spread = 1.0
    for _ in range(12):
        tried = best + spread * np.random.default_rng(1).normal(size=(4096, 3))
        tried *= radius / np.linalg.norm(tried, axis=1)[:, None]
        ways = np.linalg.norm(tried - eye, axis=1) + np.linalg.norm(tried - lamp, axis=1)
        best, spread = tried[ways.argmin()], spread / 3.0
    return np.asarray(best)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(
    ("samples", "around"), [(16, None), (256, None), (16, HAZE)], ids=["16", "256", "haze"]
)
def test_the_highlight_of_a_lamp_on_glass_is_named_whatever_the_random_numbers(
    samples: int, around: Document | None, seed: int, tmp_path: Path
) -> None:
    """A ball in a quarter of the film mirrors 4 %, and shows the lamp far smaller than a pixel:
    one photon of many millions finds it."""
    eye, lamp = np.array([0.0, 0.0, -4.0]), np.array([1.0, 1.5, -3.0])
    box = {"type": "box", "minimum": [-0.6, -0.6, -0.6], "maximum": [0.6, 0.6, 0.6]}
    document = {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": eye.tolist(),
            "look_at": [0, 0, 0],
            "up": [0, 1, 0],
            "vertical_field_of_view_degrees": _TALL,
        },
        "environment": {"radiance": 0.05},
        "tracing": {"seed": seed},
        "surfaces": [
            surface(sphere([0, 0, 0], 0.4), {"type": "dielectric", "index": 1.5}),
            surface(sphere(lamp.tolist(), 5e-4), diffuse(0.0), 1e7),
            *([{"shape": box} | around] if around else []),
        ],
        "media": _MEDIA,
    }
    (tmp_path / "scene.json").write_text(json.dumps(document))
    said = compile_to(tmp_path / "scene.json", tmp_path, _EDGE, _EDGE, samples).warnings
    x, y, z = _mirrored_on_a_ball(0.4, eye, lamp)
    half = (z - eye[2]) * tan(radians(_TALL / 2.0))
    row, column = (int(0.5 * _EDGE * (1.0 - along / half)) for along in (y, x))
    assert _named(said)[row, column], (row, column, said)
