"""Where photons start: films outside the scene, and sensors and lamps that stand in several media, or move.

Radiances are 1 and media absorb, so that most values follow from Beer's law. Each scene is traced with eight
seeds; the mean is compared by Student's t with the errors that these tell. False alarms: 0.001 for each case.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from nocturne_client.local.compiled import compile_to
from nocturne_scene.validation.documents import BLACK, GREY, box, film, measured_scene, quad, sphere, surface
from numpy.typing import NDArray
from scipy import stats

from tests.accuracy.tracing import Document, part_of, run_seeds, write

pytestmark = pytest.mark.system

_FOG = {"media": {"fog": {"absorption": 1.0}}}


def _read(
    document: Document, folder: Path, width: int = 4, height: int = 4, samples: int = 512, **tracing: object
) -> NDArray[np.float64]:
    """Mean over the rows of the `grey` channel: seeds x columns."""
    folder.mkdir(exist_ok=True)
    plain = {"sequence": "independent", "sharing": 1, "guide": "none", "direction": "adjoint"}
    compiled = compile_to(
        write(document | {"tracing": plain | tracing}, folder), folder, width, height, part_of(samples)
    )
    images = [image.further["grey"] for image, _ in run_seeds(compiled, folder, 8)]
    return np.array([image.mean(axis=0) / 470.0 for image in images])


def _forward(document: Document, folder: Path, samples: int = 4096, **more: int) -> NDArray[np.float64]:
    folder.mkdir(exist_ok=True)
    return _read(document, folder, samples=samples, direction="forward", photons_together=1, **more)


def _agree(values: NDArray[np.float64], truth: float) -> bool:
    if np.ptp(values) <= 1e-5 * abs(truth):
        return bool(abs(values.mean() / truth - 1.0) < 1e-5)
    return bool(stats.ttest_1samp(values, truth).pvalue > 0.001)


def _same(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    return bool(stats.ttest_ind(one, other, equal_var=False).pvalue > 0.001)


_BALL = surface(sphere([0, 0, 0], 0.1))
_SUN = {"distant": [{"direction": [0, 1, 0], "irradiance": 1.0}]}


@pytest.mark.parametrize(
    ("height", "size", "pixels"), [(-1.0, 2.0, (4, 4)), (1.0, 0.1, (4, 4)), (-1.0, 0.5, (16, 2))]
)
def test_the_sun_reaches_films_beside_all_surfaces(
    height: float, size: float, pixels: tuple[int, int], tmp_path: Path
) -> None:
    """A film of 2 m once read 0.014 of its illuminance under a small ball, and nothing above it. The ball's
    shadow takes 0.0314 m2 of the first film and of the last."""
    document = measured_scene(film([0, height, 0], [0, 1, 0], size), [_BALL]) | _SUN
    width, rows = pixels
    area = size * size * width / rows
    shadow = math.pi * 0.1**2 / area if height < 0 else 0.0
    read = _forward(document, tmp_path, width=width, height=rows)
    assert _agree(read.mean(axis=1), 1.0 - shadow)


def test_the_sky_reaches_a_film_beside_all_surfaces(tmp_path: Path) -> None:
    """0.012 of the right value before; of radiance 1 it is pi, less a hundredth that the ball hides."""
    document = measured_scene(film([0, -1, 0], [0, 1, 0], 0.1), [_BALL])
    document["environment"] = {"radiance": 1.0}
    read = _forward(document, tmp_path, 32768)
    assert _agree(read.mean(axis=1), math.pi * 0.99)


def test_a_film_that_moves_is_lit_all_the_way(tmp_path: Path) -> None:
    """From out of the ball's shadow, which reaches no further than 0.1 m."""
    moving = film([0.3, -1, 0], [0, 1, 0], 0.2, motion={"translate": [3, 0, 0]})
    document = measured_scene(moving, [_BALL]) | _SUN
    for direction in ("adjoint", "forward"):
        read = _read(document, tmp_path, samples=8192, direction=direction, photons_together=1)
        assert _agree(read.mean(axis=1), 1.0)


_LAMP = surface(quad([-3, -3, 3], [6, 0, 0], [0, 6, 0]), BLACK, 1.0, two_sided=True)
"""Behind the fog."""


def _fog(low: list[float], high: list[float]) -> Document:
    return {"shape": box(low, high), "interior": {"media": ["fog"]}}


def _pinhole(z: float, **more: object) -> Document:
    """A camera that looks along z, all of whose paths have one length."""
    look = {"type": "pinhole", "position": [0, 0, z], "look_at": [0, 0, 10], **more}
    return look | {"vertical_field_of_view_degrees": 0.1}


def _moves(z: float) -> Document:
    return {"motion": {"translate": [0, 0, z]}}


@pytest.mark.parametrize(
    ("camera", "motion"),
    [(_pinhole(-1, **_moves(2)), {}), (_pinhole(1, **_moves(-2)), {}), (_pinhole(-1), _moves(-2))],
    ids=["enters", "leaves", "is overrun"],
)
def test_a_camera_is_in_fog_when_it_is(camera: Document, motion: Document, tmp_path: Path) -> None:
    """Behind 2 m for half of the time, then inside, or the other way round: exp(-2) / 2, and the integral of
    exp(z - 2) from 0 to 1 over 2. Before 3.1 times too much, or 0.64 of it."""
    document = measured_scene(camera, [_fog([-1, -1, 0], [1, 1, 2]) | motion, _LAMP]) | _FOG
    assert _agree(_read(document, tmp_path).mean(axis=1), math.exp(-1) / 2)


def test_an_orthographic_camera_is_half_in_fog(tmp_path: Path) -> None:
    """The other half is clear; it was as dark as if it looked out of the fog."""
    for width in (2, 32):  # the latter so wide that no bound is known when the scene is loaded
        camera = {"type": "orthographic", "position": [0, 0, 0], "look_at": [0, 0, 1], "height": 4 / width}
        document = measured_scene(camera, [_fog([0, -2, -1], [2, 2, 2]), _LAMP]) | _FOG
        read = _read(document, tmp_path, width, 2, 4096 // width)
        one, other = read[:, : width // 2].mean(axis=1), read[:, width // 2 :].mean(axis=1)
        fog, clear = (one, other) if one.mean() < other.mean() else (other, one)
        assert _agree(fog, math.exp(-2))
        assert _agree(clear, 1.0)


def test_a_lens_is_half_in_fog(tmp_path: Path) -> None:
    """1.75 times too much before."""
    lens: Document = {"type": "thin_lens", "position": [0, 0, 0], "look_at": [0, 0, 1]}
    lens |= {"vertical_field_of_view_degrees": 0.01, "lens_radius": 0.1, "focus_distance": 1e5}
    document = measured_scene(lens, [_fog([0, -2, -1], [2, 2, 2]), _LAMP]) | _FOG
    assert _agree(_read(document, tmp_path).mean(axis=1), (1.0 + math.exp(-2)) / 2)


def test_a_film_is_half_in_fog(tmp_path: Path) -> None:
    """Photons from the lamp know where they are."""
    document = measured_scene(film([0, 0, 0], [0, 0, 1], 2.0), [_fog([0, -2, -1], [2, 2, 2]), _LAMP]) | _FOG
    adjoint, forward = _read(document, tmp_path / "adjoint"), _forward(document, tmp_path / "forward")
    for columns in (slice(0, 2), slice(2, 4)):
        assert _same(adjoint[:, columns].mean(axis=1), forward[:, columns].mean(axis=1))


def _floor_in_fog(lamps: Document) -> Document:
    dark = surface(quad([-3, -1, -3], [0, 0, 8], [8, 0, 0]))
    document = measured_scene(film([3, 0, 0], [0, 1, 0], 0.3), [_fog([2, -0.5, -1], [4, 2, 1]), dark])
    document["surfaces"] += lamps.pop("surfaces", [])
    return document | lamps | {"media": {"fog": {"absorption": 1.5}}}


@pytest.mark.parametrize("first", [0, 1])
def test_each_instance_of_a_lamp_stands_where_it_is(first: int, tmp_path: Path) -> None:
    """In the air, and in the fog with the film: all photons of both started in the medium of the first, and
    brought 3.7 times too much."""
    lamp = surface(sphere([0, 0, 0], 0.1), BLACK, 10.0)
    places = [{"group": "lamp", "translate": [x, 1, 0]} for x in (0, 3)]
    shown = [places[first], places[1 - first]]
    document = _floor_in_fog({"groups": {"lamp": [lamp]}, "instances": shown})
    adjoint, forward = _read(document, tmp_path / "adjoint"), _forward(document, tmp_path / "forward")
    assert _same(adjoint.mean(axis=1), forward.mean(axis=1))


def test_a_lamp_moves_into_fog(tmp_path: Path) -> None:
    """3.4 times too much before."""
    lamp = surface(sphere([3, 3, 0], 0.1), BLACK, 10.0) | {"motion": {"translate": [0, -2, 0]}}
    document = _floor_in_fog({"surfaces": [lamp]})
    adjoint, forward = _read(document, tmp_path / "adjoint"), _forward(document, tmp_path / "forward")
    assert _same(adjoint.mean(axis=1), forward.mean(axis=1))


def test_a_lamp_stands_half_in_fog(tmp_path: Path) -> None:
    """A ball on the fog's top, which photons leave above and below it."""
    document = _floor_in_fog({"surfaces": [surface(sphere([3, 2, 0], 0.2), BLACK, 10.0)]})
    adjoint, forward = _read(document, tmp_path / "adjoint"), _forward(document, tmp_path / "forward")
    assert _same(adjoint.mean(axis=1), forward.mean(axis=1))


def test_the_skin_of_fog_shines_into_it(tmp_path: Path) -> None:
    """To a film in the middle of a ball of radius 1: pi exp(-1). Photons that leave a skin backwards were
    taken to be outside."""
    skin = {"shape": sphere([0, 0, 0], 1.0), "interior": {"media": ["fog"]}}
    skin["luminaire"] = {"radiance": 1.0, "two_sided": True}
    document = measured_scene({**GREY, **film([0, 0, 0], [0, 0, 1], 0.05)}, [skin]) | _FOG
    assert _agree(_forward(document, tmp_path, 65536).mean(axis=1), math.pi * math.exp(-1))
