"""Documents as scenes of Mitsuba's: what is written, and what is refused by name.

That they look the same is tested with Mitsuba itself: tests/mitsuba/test_exports.py.
"""

import json
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, parse

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.exporting import export_to
from nocturne_client.local.programs import CHECKOUT
from nocturne_coordinator.exporting import skies
from nocturne_coordinator.exporting.compiled import Film, table_of
from nocturne_coordinator.exporting.export_scene import Exported

LAMP = {
    "shape": {"type": "quad", "corner": [-1, 3, -1], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2]},
    "kernel": {"type": "lambertian", "reflectance": 0.0},
    "luminaire": {"radiance": 1.0},
}
BALL = {"type": "sphere", "centre": [0, 0, 0], "radius": 1}


def export(tmp_path: Path, *surfaces: Any, **parts: Any) -> tuple[Element, Exported]:
    sensor = {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "vertical_field_of_view_degrees": 40,
    }
    allowed = parts.pop("allow_missing", False)
    document = {"nocturne": 1, "sensor": sensor, "surfaces": [LAMP, *surfaces], **parts}
    (tmp_path / "scene.json").write_text(json.dumps(document))
    found = export_to(
        tmp_path / "scene.json", tmp_path / "out", "mitsuba", Film(40, 30, 16), allow_missing=allowed
    )
    return parse(found.scene).getroot(), found  # noqa: S314 - we wrote it


def refused(tmp_path: Path, *surfaces: Any, **parts: Any) -> list[str]:
    with pytest.raises(NocturneClientError) as raised:
        export(tmp_path, *surfaces, **parts)
    assert not (tmp_path / "out").exists()
    assert not list(tmp_path.glob(".export-*"))
    return [str(problem) for problem in raised.value.problems]


@pytest.mark.parametrize(
    ("kernel", "said"),
    [
        ({"type": "dielectric", "index": "N-BK7"}, "depends on wavelength has no equal in Mitsuba"),
        ({"type": "coated_diffuse", "index": 1.5, "reflectance": 0.5, "roughness": 0.1}, "a rough coat"),
        ({"type": "phong", "reflectance": 0.5, "exponent": 10}, "the kernel phong"),
        ({"type": "diffuse_transmitter", "reflectance": 0.5, "transmittance": 0.5}, "diffuse_transmitter"),
        ({"type": "thin_pane", "index": 1.5, "transmittance": 0.5}, "a pane that absorbs"),
        (
            {"type": "two_sided", "front": {"type": "conductor", "index": "Ag"}, "back": {"type": "passage"}},
            "lets light through",
        ),
    ],
)
def test_kernels_without_an_equal_are_named(kernel: Any, said: str, tmp_path: Path) -> None:
    [problem] = refused(tmp_path, {"shape": BALL, "kernel": kernel})
    assert problem.startswith("$.surfaces[1].kernel: ")
    assert said in problem


def test_the_rest_is_exported_where_that_is_allowed(tmp_path: Path) -> None:
    kernel = {"type": "coated_diffuse", "index": 1.5, "reflectance": 0.5, "roughness": 0.1}
    root, found = export(tmp_path, {"shape": BALL, "kernel": kernel}, allow_missing=True)
    assert root.find(".//bsdf[@type='roughplastic']") is not None
    assert [problem.place for problem in found.missing] == ["$.surfaces[1].kernel"]


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        ("prism", ["$.surfaces[0].kernel: an index", "$.surfaces[1].luminaire.profile: "]),
        ("fog", ["$.surfaces[1].interior: a phase function"]),
        (
            "sky",
            [
                "$.sensor: a sensor of the kind panorama",
                "$.atmosphere: ",
                "$.atmosphere.interior",
                "$.distant",
            ],
        ),
    ],
)
def test_scenes_beyond_the_subset_are_refused(scene: str, said: list[str], tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError) as raised:
        export_to(CHECKOUT / "scenes" / scene / "scene.json", tmp_path / "out", "mitsuba", Film(8, 8, 1))
    told = [str(problem) for problem in raised.value.problems]
    assert len(told) == len(said)
    assert all(problem.startswith(start) for problem, start in zip(told, said, strict=True))


def test_bodies_that_may_overlap_are_refused(tmp_path: Path) -> None:
    glass = {"kernel": {"type": "dielectric", "index": 1.5}}
    other = {"type": "sphere", "centre": [1.5, 0, 0], "radius": 1}
    [problem] = refused(tmp_path, {"shape": BALL, **glass}, {"shape": other, **glass})
    assert problem.startswith("$.surfaces[2]: may overlap with $.surfaces[1]")


@pytest.mark.parametrize(
    ("inside", "shape"),
    [
        (True, {"type": "box", "minimum": [-1, -1, 3], "maximum": [1, 1, 5]}),
        (False, {"type": "box", "minimum": [-1, -1, 1], "maximum": [1, 1, 3]}),
        (True, {"type": "sphere", "centre": [0, 0, 3.5], "radius": 1}),
        (False, BALL),
    ],
)
def test_the_sensor_is_in_the_medium_that_it_stands_in(inside: bool, shape: Any, tmp_path: Path) -> None:
    root, _ = export(tmp_path, {"shape": shape, "interior": {"media": ["m"]}}, media={"m": {"scattering": 1}})
    reference = root.find("sensor/ref")
    assert (reference is not None) == inside


def test_small_scenes_are_written_large(tmp_path: Path) -> None:
    ball = {"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 0.25}, "interior": {"media": ["m"]}}
    root, _ = export(tmp_path, ball, media={"m": {"scattering": 3, "absorption": 1}})
    shape = root.find("shape[@type='sphere']")
    assert shape is not None
    [radius] = [float(each.get("value", "")) for each in shape.findall("float")]
    # The sensor is 4 m away: one metre became a thousand.
    assert radius == 250
    medium = root.find("medium")
    assert medium is not None
    values = {each.get("name"): float(each.get("value", "")) for each in medium.findall("spectrum")}
    assert values == {"sigma_t": pytest.approx(4e-3), "albedo": pytest.approx(0.75)}


def test_blends_of_blends_become_such_again(tmp_path: Path) -> None:
    grey, gold = {"type": "lambertian", "reflectance": 0.5}, {"type": "conductor", "index": "Au"}
    kernel = {
        "type": "mask",
        "opacity": 0.75,
        "kernel": {"type": "blend", "first": grey, "second": gold, "weight": 0.25},
    }
    root, _ = export(tmp_path, {"shape": BALL, "kernel": kernel})
    mask = root.find("bsdf[@type='mask']")
    assert mask is not None
    assert [each.get("value") for each in mask.findall("float")] == ["0.75"]
    blend = mask.find("bsdf[@type='blendbsdf']")
    assert blend is not None
    assert [each.get("value") for each in blend.findall("float")] == ["0.25"]
    assert [each.get("type") for each in blend.findall("bsdf/bsdf")] == ["diffuse", "conductor"]


def test_lines_are_triangles_of_their_power() -> None:
    lines = [scene_pb2.Line(centre_nm=546.1, power=3.0, width_nm=0.5)]
    table = table_of(scene_pb2.Spectrum(values=[0.25], lines=lines))
    assert table.wavelengths is not None
    assert np.trapezoid(table.values, table.wavelengths) == pytest.approx(0.25 * 470 + 3.0)
    assert table.at(np.array([400.0, 546.1])) == pytest.approx([0.25, 0.25 + 6.0])


def test_what_holds_beyond_a_table_is_written() -> None:
    table = table_of(scene_pb2.Spectrum(first_nm=400, step_nm=100, values=[1, 2, 3]))
    assert table.at(np.array([360.0, 450.0, 830.0])).tolist() == [1, 1.5, 3]
    dark = table_of(scene_pb2.Spectrum(first_nm=400, step_nm=100, values=[1, 2, 3], zero_outside=True))
    assert dark.at(np.array([360.0, 450.0, 830.0])).tolist() == [0, 1.5, 0]


def test_a_sky_keeps_its_light() -> None:
    """Radiance times solid angle, by the trapezoidal rule between rows, as a renderer interpolates them."""
    texels = np.random.default_rng(3).uniform(0, 1, (6, 8, 3))
    picture = skies.latitudes_with_poles(texels)
    assert picture.shape[1] % 8 == 0
    polar = np.linspace(0, np.pi, len(picture))
    weight = np.sin(polar) * (polar[1] - polar[0]) / 2
    found = np.einsum("i,ijk->k", weight, picture) / picture.shape[1]
    assert found == pytest.approx(texels.mean(axis=(0, 1)), rel=1e-3)
