"""Light groups: their channels are the whole image, each is what its lights alone would bring, and their
mixes are the images of dimmed lights, with errors that hold."""

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.local.compiled import compile_to
from nocturne_coordinator.output.mixes import write_mix
from nocturne_scene.compare.images import read_picture
from nocturne_scene.tile_sums import Values
from numpy.typing import NDArray

from tests.accuracy.tracing import Document, part_of, run_seeds, trace, write
from tests.coordinator.service import read_channel
from tests.system.images import Image

pytestmark = pytest.mark.system

_GREY = {"type": "lambertian", "reflectance": 0.6}
_CAMERA = {
    "type": "pinhole",
    "position": [0, 1, 3.5],
    "look_at": [0, 0.7, 0],
    "vertical_field_of_view_degrees": 50,
}
_METER = {"type": "irradiance_meter", "position": [0, 0.75, 0], "normal": [0, 1, 0], "height": 2}
_GROUPS = ("lamps", "sun", "windows", "rest")


def _quad(centre: list[float], u: list[float], v: list[float], **more: Any) -> Document:
    corner = [c - a / 2 - b / 2 for c, a, b in zip(centre, u, v, strict=True)]
    return {"shape": {"type": "quad", "corner": corner, "edge_u": u, "edge_v": v}, "kernel": _GREY, **more}


def _lamp(x: float, light_group: str, lumens: float) -> Document:
    luminaire = {"radiance": {"blackbody": 3000}, "lumens": lumens}
    if light_group:
        luminaire["light_group"] = light_group
    return _quad([x, 1.9, 0.3], [0.4, 0, 0], [0, 0, 0.4], luminaire=luminaire)


def _room(sensor: Document = _CAMERA, **tracing: Any) -> Document:
    """A room open towards a sky, with two lamps, one of them in no group, and a Sun."""
    return {
        "nocturne": 1,
        "sensor": copy.deepcopy(sensor),
        "environment": {"cie": 16, "illuminance": 800, "light_group": "windows"},
        "distant": [
            {
                "direction": [0.3, 1, 1.2],
                "irradiance": {"table": [[360, 1e-3], [830, 2e-3]]},
                "angular_diameter_degrees": 4.0,
                "light_group": "sun",
            }
        ],
        "surfaces": [
            _quad([0, 0, 0], [0, 0, 3], [3, 0, 0]),
            _quad([0, 2, 0], [3, 0, 0], [0, 0, 3]),
            _quad([0, 1, -1.5], [3, 0, 0], [0, 2, 0]),
            _quad([-1.5, 1, 0], [0, 0, 3], [0, 2, 0]),
            _lamp(-0.7, "lamps", 900),
            _lamp(0.7, "", 300),
        ],
        "tracing": tracing,
    }


def _in_fog(document: Document) -> Document:
    document["media"] = {"fog": {"scattering": 0.3, "absorption": 0.05}}
    document["surfaces"].append(
        {
            "shape": {"type": "sphere", "centre": [0.5, 0.5, 0], "radius": 0.4},
            "kernel": {"type": "lambertian", "reflectance": 0.0},
            "interior": {"media": ["fog"]},
        }
    )
    return document


def _without_groups(document: Document) -> Document:
    found = copy.deepcopy(document)
    lamps = (surface["luminaire"] for surface in found["surfaces"] if "luminaire" in surface)
    for light in (found["environment"], *found["distant"], *lamps):
        light.pop("light_group", None)
    return found


def _alone(document: Document, group: str) -> Document:
    """The scene with the lights of one group."""
    found = _without_groups(document)
    if group != "sun":
        found["distant"] = []
    if group != "windows":
        del found["environment"]
    for surface, name in zip(found["surfaces"][4:6], ("lamps", "rest"), strict=True):
        if name != group:
            del surface["luminaire"]
    return found


def _channels(image: Path, group: str, what: str = "") -> Values:
    found = [read_channel(image, f"{group}.{axis}{what}") for axis in "XYZ"]
    return np.stack(found, axis=-1).astype(np.float64)


_METHODS: list[tuple[Document, Document]] = [
    (_CAMERA, {"direction": "adjoint"}),
    (_CAMERA, {"direction": "adjoint", "sharing": 16}),
    (_CAMERA, {"direction": "both"}),
    (_CAMERA, {"direction": "adjoint", "photons_together": 1}),
    (_METER, {"direction": "adjoint"}),
    (_METER, {"direction": "forward"}),
]


@pytest.mark.parametrize("fog", [False, True])
@pytest.mark.parametrize(("sensor", "tracing"), _METHODS)
def test_groups_are_the_whole_image_and_change_none_of_its_bits(
    tmp_path: Path, sensor: Document, tracing: Document, fog: bool
) -> None:
    """One tile: tiles are smaller with further responses, and pixels share within tiles. Photons of lamps are
    shared out among groups, and have other bits."""
    document = _room(sensor, **tracing)
    if fog:
        document = _in_fog(document)
    (tmp_path / "without").mkdir()
    alone = trace(_without_groups(document), tmp_path / "without", 16, 64)
    image = trace(document, tmp_path, 16, 64)
    if tracing["direction"] != "forward":  # their photons are shared out among the groups
        np.testing.assert_array_equal(image.xyz, alone.xyz)
        np.testing.assert_array_equal(image.y_stderr, alone.y_stderr)
    parts = np.array([_channels(tmp_path / "image.exr", group) for group in _GROUPS])
    assert np.all(parts.max(axis=(1, 2, 3)) > 0.0)
    # Of float32 in the image, and of shares of light that arrives from one direction.
    np.testing.assert_allclose(parts.sum(axis=0), image.xyz, rtol=2e-6, atol=1e-5)


@pytest.mark.parametrize("together", [1, 4])
@pytest.mark.parametrize("sensor", [_CAMERA, _METER])
def test_groups_behind_a_polariser_are_the_whole_image(
    tmp_path: Path, sensor: Document, together: int
) -> None:
    """Photons that know how light is polarised count light groups as others do, unless they are asked for a
    Stokes vector: a crossing of a retarder, a light group and a meter wrote beyond its sums."""
    document = _in_fog(_room(sensor, direction="adjoint", photons_together=together))
    pane = _quad([0.2, 1.2, 0.4], [0.8, 0, 0], [0, 0, 0.8])
    document["surfaces"].append(pane | {"kernel": {"type": "polariser", "axis": [1, 0, 0.3]}})
    (tmp_path / "without").mkdir()
    alone = trace(_without_groups(document), tmp_path / "without", 16, 64)
    image = trace(document, tmp_path, 16, 64)
    np.testing.assert_array_equal(image.xyz, alone.xyz)
    parts = np.array([_channels(tmp_path / "image.exr", group) for group in _GROUPS])
    assert np.all(parts.max(axis=(1, 2, 3)) > 0.0)
    np.testing.assert_allclose(parts.sum(axis=0), image.xyz, rtol=2e-6, atol=1e-5)


@pytest.mark.parametrize("sensor", [_CAMERA, _METER])
def test_groups_are_the_whole_image_as_a_pilot_has_it_traced(tmp_path: Path, sensor: Document) -> None:
    """With whatever it learns of the light, and pixels that share. A pilot is asked from 2^18 samples on."""
    image = trace(_room(sensor), tmp_path, 64, 64)
    parts = np.sum([_channels(tmp_path / "image.exr", group) for group in _GROUPS], axis=0)
    np.testing.assert_allclose(parts, image.xyz, rtol=2e-6, atol=1e-5)


@pytest.mark.parametrize(
    ("sensor", "tracing"),
    [
        (_CAMERA, {"direction": "adjoint"}),
        (_CAMERA, {"direction": "adjoint", "sharing": 16}),
        (_CAMERA, {"direction": "both"}),
        (_METER, {"direction": "forward"}),
    ],
)
def test_each_group_is_what_its_lights_alone_bring(
    tmp_path: Path, sensor: Document, tracing: Document
) -> None:
    """Eight seeds of both, by the scatter of each, in 4 x 4 parts of the film."""
    seeds, samples = 8, part_of(1024)
    whole = compile_to(write(_room(sensor, **tracing), tmp_path), tmp_path, 16, 16, samples)
    run_seeds(whole, tmp_path, seeds)
    for group in _GROUPS:
        folder = tmp_path / group
        folder.mkdir()
        alone = compile_to(write(_alone(_room(sensor, **tracing), group), folder), folder, 16, 16, samples)
        others = [_parts(image.xyz) for image, _ in run_seeds(alone, folder, seeds)]
        found = [_parts(_channels(tmp_path / f"{seed}.exr", group)) for seed in range(1, seeds + 1)]
        error = np.sqrt((np.var(found, axis=0, ddof=1) + np.var(others, axis=0, ddof=1)) / seeds)
        z = (np.mean(found, axis=0) - np.mean(others, axis=0)) / error
        # Student's t of 14 degrees has a standard deviation of 1.08, and X, Y, Z go together.
        assert abs(z[..., 1].mean()) < 4 * 1.08 / np.sqrt(z[..., 1].size), group
        assert np.abs(z).max() < 6.0, group


def test_a_dim_group_gets_photons_of_luminaires(tmp_path: Path) -> None:
    """Of one lumen next to 900 and a Sun. By power alone a group gets one photon in ten thousands, and reads
    0 +- 0 on most films."""
    scatter, means = {}, {}
    for direction in ("forward", "adjoint"):
        folder = tmp_path / direction
        folder.mkdir()
        document = _room(_METER, direction=direction)
        document["surfaces"][5]["luminaire"]["lumens"] = 1
        compiled = compile_to(write(document, folder), folder, 8, 8, part_of(256))
        run_seeds(compiled, folder, 8)
        for group in ("lamps", "rest"):
            y = [_channels(folder / f"{seed}.exr", group)[..., 1].mean() for seed in range(1, 9)]
            means[direction, group] = np.mean(y)
            scatter[direction, group] = np.std(y, ddof=1)
    dim, bright = (scatter["forward", each] / means["forward", each] for each in ("rest", "lamps"))
    assert dim < 4 * bright
    error = np.hypot(scatter["forward", "rest"], scatter["adjoint", "rest"]) / np.sqrt(8)
    # Student's t of 7 to 14 degrees: one false alarm in 300 or less.
    assert abs(means["forward", "rest"] - means["adjoint", "rest"]) < 4 * error


def _parts(pixels: NDArray[np.floating[Any]]) -> Values:
    found: Values = pixels.astype(np.float64).reshape(4, 4, 4, 4, 3).mean(axis=(1, 3))
    return found


_FACTORS = {"lamps": 0.3, "windows": 2.0, "sun": 0.0}


def _mixed(image: Path, factors: dict[str, float]) -> Path:
    output = image.with_suffix(".mix.exr")
    write_mix(image, output, factors)
    return output


def test_a_mix_by_ones_is_the_image_with_its_errors(tmp_path: Path) -> None:
    image = trace(_room(), tmp_path, (40, 24), 64)
    _mixed(tmp_path / "image.exr", {})
    mix = Image.read(tmp_path / "image.mix.exr")
    np.testing.assert_allclose(mix.xyz, image.xyz, rtol=2e-6, atol=1e-5)
    np.testing.assert_allclose(mix.y_stderr, image.y_stderr, rtol=1e-4, atol=1e-5)


def test_a_mix_is_the_image_of_dimmed_lights(tmp_path: Path) -> None:
    tracing = {"sequence": "independent", "direction": "adjoint", "sharing": 1}
    trace(_room(_METER, seed=3, **tracing), tmp_path, 8, 4096)
    mix = Image.read(_mixed(tmp_path / "image.exr", _FACTORS))
    dimmed = _room(_METER, seed=4, **tracing)
    dimmed["environment"]["illuminance"] *= 2.0
    dimmed["distant"] = []
    dimmed["surfaces"][4]["luminaire"]["dimming"] = 0.3
    (tmp_path / "dimmed").mkdir()
    other = trace(dimmed, tmp_path / "dimmed", 8, 4096)
    z = (mix.y - other.y) / np.hypot(mix.y_stderr, other.y_stderr)
    assert abs(z.mean()) < 4 / np.sqrt(z.size)
    assert z.std() == pytest.approx(1.0, abs=4 / np.sqrt(2 * z.size))


@pytest.mark.parametrize("sharing", [1, 16])
@pytest.mark.parametrize("sensor", [_CAMERA, _METER])
def test_errors_of_mixes_are_those_of_many_renders(tmp_path: Path, sensor: Document, sharing: int) -> None:
    """The scatter of 100 seeds is what each of them says, in sum over 64 pixels. That of independent pixels
    is known to sqrt(2 / 6400), 2 %; those that share are fewer. Sobol's are more even than errors say."""
    document = _room(sensor, sharing=sharing, direction="adjoint", sequence="independent")
    run_seeds(compile_to(write(document, tmp_path), tmp_path, 8, 8, 128), tmp_path, 100)
    for factors in ({}, _FACTORS, {"sun": 0.0, "rest": 3.0}):
        mixes = [_mixed(tmp_path / f"{seed}.exr", factors) for seed in range(1, 101)]
        scatter = np.var([Image.read(mix).xyz for mix in mixes], axis=0, ddof=1).sum(axis=(0, 1))
        said = np.mean([_squares_of_errors(mix) for mix in mixes], axis=0).sum(axis=(0, 1))
        assert scatter / said == pytest.approx(np.ones(3), abs=0.12), factors


def _squares_of_errors(image: Path) -> Values:
    errors = [read_channel(image, f"{axis}.stderr") for axis in "XYZ"]
    return np.square(np.stack(errors, axis=-1).astype(np.float64))


def test_a_mix_keeps_what_is_measured_by(tmp_path: Path) -> None:
    trace(_room(_METER), tmp_path, 8, 64)
    picture = read_picture(_mixed(tmp_path / "image.exr", {"rest": 0.0}))
    assert picture.moments is not None
    assert picture.names == ("X", "Y", "Z")
