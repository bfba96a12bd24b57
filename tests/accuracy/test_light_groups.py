"""Light groups: their channels are the whole image, and their mixes are the images of dimmed lights, with
errors that hold."""

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.local.compiled import compile_to
from nocturne_coordinator.output.mixes import write_mix
from nocturne_scene.compare.images import read_picture
from nocturne_scene.errors import InputError
from numpy.typing import NDArray

from tests.accuracy.tracing import Document, run_seeds, trace, write
from tests.coordinator.service import read_channel
from tests.system.images import Image

_GREY = {"type": "lambertian", "reflectance": 0.6}


def _quad(centre: list[float], u: list[float], v: list[float], **more: Any) -> Document:
    corner = [c - a / 2 - b / 2 for c, a, b in zip(centre, u, v, strict=True)]
    return {"shape": {"type": "quad", "corner": corner, "edge_u": u, "edge_v": v}, "kernel": _GREY, **more}


def _lamp(x: float, light_group: str, **light: Any) -> Document:
    return _quad(
        [x, 1.9, 0.3],
        [0.4, 0, 0],
        [0, 0, 0.4],
        luminaire={
            "radiance": {"blackbody": 3000},
            **light,
            **({"light_group": light_group} if light_group else {}),
        },
    )


def _room(sensor: Document, **tracing: Any) -> Document:
    """A room open towards a sky, with two lamps, one of them in no group, and a Sun."""
    camera = {
        "type": "pinhole",
        "position": [0, 1, 3.5],
        "look_at": [0, 0.7, 0],
        "vertical_field_of_view_degrees": 50,
    }
    return {
        "nocturne": 1,
        "sensor": sensor or camera,
        "environment": {"cie": 16, "illuminance": 800, "light_group": "windows"},
        "distant": [
            {
                "direction": [0.3, 1, 1.2],
                "irradiance": {"type": "table", "knots": [[360, 1e-3], [830, 2e-3]]},
                "light_group": "sun",
            }
        ],
        "surfaces": [
            _quad([0, 0, 0], [0, 0, 3], [3, 0, 0]),
            _quad([0, 2, 0], [3, 0, 0], [0, 0, 3]),
            _quad([0, 1, -1.5], [3, 0, 0], [0, 2, 0]),
            _quad([-1.5, 1, 0], [0, 0, 3], [0, 2, 0]),
            _lamp(-0.7, "lamps", lumens=900),
            _lamp(0.7, "", lumens=300),
        ],
        "tracing": tracing,
    }


_METER = {"type": "irradiance_meter", "position": [0, 0.75, 0], "normal": [0, 1, 0], "height": 2}
_GROUPS = ("lamps", "sun", "windows", "rest")


def _without_groups(document: Document) -> Document:
    found = copy.deepcopy(document)
    for light in (
        found["environment"],
        *found["distant"],
        *(each.get("luminaire", {}) for each in found["surfaces"]),
    ):
        light.pop("light_group", None)
    return found


@pytest.mark.parametrize(
    ("sensor", "tracing"),
    [
        ({}, {}),
        ({}, {"sharing": 16}),
        ({}, {"direction": "both"}),
        ({}, {"estimator": "mixture", "photons_together": 1}),
        (_METER, {"direction": "adjoint"}),
        (_METER, {"direction": "forward"}),
    ],
)
def test_groups_are_the_whole_image_and_change_none_of_its_bits(
    tmp_path: Path, sensor: Document, tracing: Document
) -> None:
    document = _room(sensor, **tracing)
    (tmp_path / "without").mkdir()
    alone = trace(_without_groups(document), tmp_path / "without", (24, 16), 64)
    image = trace(document, tmp_path, (24, 16), 64)
    np.testing.assert_array_equal(image.xyz, alone.xyz)
    np.testing.assert_array_equal(image.y_stderr, alone.y_stderr)
    for index, axis in enumerate("XYZ"):
        parts = [image.further[f"{group}.{axis}"] for group in _GROUPS]
        assert all(part.max() > 0 for part in parts)
        np.testing.assert_allclose(np.sum(parts, axis=0), image.xyz[..., index], rtol=2e-6, atol=1e-5)


_FACTORS = {"lamps": 0.3, "windows": 2.0, "sun": 0.0}


def _mixed(image: Path, factors: dict[str, float]) -> Image:
    output = image.with_suffix(".mix.exr")
    write_mix(image, output, factors)
    return Image.read(output)


def test_a_mix_by_ones_is_the_image_with_its_error(tmp_path: Path) -> None:
    image = trace(_room({}), tmp_path, (24, 16), 64)
    mix = _mixed(tmp_path / "image.exr", {})
    np.testing.assert_allclose(mix.xyz, image.xyz, rtol=2e-6, atol=1e-5)
    # Groups see too few of rare finds each by itself, and say so.
    assert np.median(mix.y_stderr / image.y_stderr) == pytest.approx(1.0, abs=0.02)


def test_a_mix_is_the_image_of_dimmed_lights(tmp_path: Path) -> None:
    document = _room(_METER, seed=3)
    trace(document, tmp_path, (8, 8), 4096)
    mix = _mixed(tmp_path / "image.exr", _FACTORS)
    dimmed = _room(_METER, seed=4)
    dimmed["environment"]["illuminance"] *= 2.0
    dimmed["distant"] = []
    dimmed["surfaces"][4]["luminaire"]["dimming"] = 0.3
    (tmp_path / "dimmed").mkdir()
    other = trace(dimmed, tmp_path / "dimmed", (8, 8), 4096)
    z = (mix.y - other.y) / np.hypot(mix.y_stderr, other.y_stderr)
    assert abs(z.mean()) < 4 / np.sqrt(z.size)
    assert 0.75 < z.std() < 1.25


@pytest.mark.parametrize("sensor", [{}, _METER])
def test_errors_of_mixes_are_those_of_many_renders(tmp_path: Path, sensor: Document) -> None:
    """The scatter of 100 seeds is what each of them says, in sum over pixels."""
    compiled = compile_to(write(_room(sensor, sharing=1), tmp_path), tmp_path, 8, 8, 128)
    run_seeds(compiled, tmp_path, 100)
    images = [tmp_path / f"{seed}.exr" for seed in range(1, 101)]
    for factors in ({}, _FACTORS, {"sun": 0.0, "rest": 3.0}):
        mixes = [_mixed(image, factors) for image in images]
        scatter = np.var([mix.xyz for mix in mixes], axis=0, ddof=1).sum(axis=(0, 1))
        said = np.mean([np.square(_errors(image)) for image in images], axis=0).sum(axis=(0, 1))
        assert scatter[1] / said[1] == pytest.approx(1.0, abs=0.12), factors
        assert np.all(scatter[[0, 2]] < 1.12 * said[[0, 2]])


def _errors(image: Path) -> NDArray[np.float32]:
    mix = image.with_suffix(".mix.exr")
    return np.stack([read_channel(mix, f"{axis}.stderr") for axis in "XYZ"], axis=-1)


def test_a_mix_keeps_what_is_measured_by(tmp_path: Path) -> None:
    trace(_room(_METER), tmp_path, (8, 8), 64)
    _mixed(tmp_path / "image.exr", {"rest": 0.0})
    picture = read_picture(tmp_path / "image.mix.exr")
    assert picture.moments is not None
    assert picture.names == ("X", "Y", "Z")


@pytest.mark.parametrize(
    ("factors", "message"),
    [
        ({"doors": 1.0}, "there is no light group 'doors'; expected lamps, rest, sun, windows"),
        ({"sun": -1.0}, "sun = -1; expected a factor from 0 to 1e+06"),
        ({"sun": float("nan")}, "sun = nan; expected a factor from 0 to 1e+06"),
    ],
)
def test_factors_that_make_no_mix_are_refused(
    tmp_path: Path, factors: dict[str, float], message: str
) -> None:
    trace(_room(_METER), tmp_path, (8, 8), 4)
    with pytest.raises(InputError) as refused:
        write_mix(tmp_path / "image.exr", tmp_path / "mix.exr", factors)
    assert refused.value.problems[0].message == message
    assert not (tmp_path / "mix.exr").exists()


def test_images_without_groups_have_no_mixes(tmp_path: Path) -> None:
    trace(_without_groups(_room(_METER)), tmp_path, (8, 8), 4)
    with pytest.raises(InputError, match="tells no light groups apart"):
        write_mix(tmp_path / "image.exr", tmp_path / "mix.exr", {})
