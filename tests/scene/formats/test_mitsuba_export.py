"""Documents as scenes of Mitsuba's: the written features, and those that are refused by name.

That they look the same is tested with Mitsuba itself: tests/mitsuba/test_exports.py. It is long by
the many features that are written.
"""

import json
import struct
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, parse

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.exporting import export_to
from nocturne_client.local.programs import CHECKOUT
from nocturne_scene.film import Film
from nocturne_scene.formats.export_scene import Exported
from nocturne_scene.formats.mitsuba.write import volumes
from nocturne_scene.formats.writing import skies
from nocturne_scene.formats.writing.tables import table_of
from nocturne_scene.media import grid_files

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
    tmp_path.mkdir(exist_ok=True)
    with pytest.raises(NocturneClientError) as raised:
        export(tmp_path, *surfaces, **parts)
    assert not (tmp_path / "out").exists()
    assert not list(tmp_path.glob(".export-*"))
    return [str(problem) for problem in raised.value.problems]


def test_a_black_sky_where_light_passes_surfaces_straight(tmp_path: Path) -> None:
    """Without any sky, Mitsuba's paths that only pass surfaces are black, whatever light they found."""
    grey: Any = {"type": "lambertian", "reflectance": 0.5}
    mask = {"type": "blend", "first": grey, "second": {"type": "null"}, "weight": 0.3}
    pane = {**LAMP, "kernel": {"type": "null"}, "luminaire": {"radiance": 1.0, "two_sided": False}}
    sun = [{"direction": [0, 1, 0], "sun": True}]
    cases: list[tuple[Any, Any, list[str]]] = [
        (pane, {}, ["0.0"]),
        ({"shape": BALL, "kernel": mask}, {}, ["0.0"]),
        ({"shape": BALL, "kernel": grey}, {}, []),
        ({"shape": BALL, "kernel": grey}, {"distant": sun}, ["0.0"]),
        (pane, {"environment": {"radiance": 1.0}}, ["1.0"]),
    ]
    for case, (surface, parts, constants) in enumerate(cases):
        (folder := tmp_path / str(case)).mkdir()
        root, _ = export(folder, surface, **parts)
        found = [each.find("spectrum") for each in root.iter("emitter") if each.get("type") == "constant"]
        assert [each.get("value") for each in found if each is not None] == constants


@pytest.mark.parametrize(
    ("kernel", "said"),
    [
        ({"type": "dielectric", "index": "N-BK7"}, "depends on wavelength has no equal in Mitsuba"),
        ({"type": "coated_diffuse", "index": 1.5, "reflectance": 0.5, "roughness": 0.1}, "a rough coat"),
        ({"type": "phong", "reflectance": 0.5, "exponent": 10}, "the kernel phong"),
        ({"type": "diffuse_transmitter", "reflectance": 0.5, "transmittance": 0.5}, "diffuse_transmitter"),
        ({"type": "thin_pane", "index": 1.5, "transmittance": 0.5}, "a pane that absorbs"),
        (
            {"type": "conductor", "index": "Ag", "coating": [{"index": 1.5, "thickness_nm": 90}]},
            "a coating has no equal in Mitsuba",
        ),
        (
            {"type": "dielectric", "index": 1.5, "coating": [{"index": 1.38, "thickness_nm": 90}]},
            "a coating has no equal in Mitsuba",
        ),
        ({"type": "glazing", "panes": [{"index": 1.5}]}, "the kernel glazing has no equal in Mitsuba"),
        (
            {
                "type": "mask",
                "kernel": {
                    "type": "two_sided",
                    "front": {"type": "conductor", "index": "Ag"},
                    "back": {"type": "lambertian", "reflectance": 0.5},
                },
                "opacity": 0.5,
            },
            "two different sides that let light through",
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
                "$.atmosphere: a density that depends on altitude",
            ],
        ),
    ],
)
def test_scenes_beyond_the_subset_are_refused(scene: str, said: list[str], tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError) as raised:
        export_to(CHECKOUT / "examples" / scene / "scene.json", tmp_path / "out", "mitsuba", Film(8, 8, 1))
    told = [str(problem) for problem in raised.value.problems]
    assert len(told) == len(said)
    assert all(problem.startswith(start) for problem, start in zip(told, said, strict=True))


SMOKE = {"shape": {"type": "medium_box", "medium": "m"}, "interior": {"media": ["m"]}}
DENSITY = {"asset": "smoke.vdb", "grid": "density"}


@pytest.fixture
def smoke(tmp_path: Path) -> Path:
    """Two voxels of a grid, in one block of 8^3."""
    grid_files.create(tmp_path / "smoke.vdb", "density", np.array([[[0.5, 1.0]]]), 0.25)
    return tmp_path


def test_a_grid_has_the_units_and_layout_of_mitsuba(smoke: Path) -> None:
    """Its file by numbers; 3 per metre at density 1, of which the grid has 2, and a metre is 1000."""
    density = {**DENSITY, "factor": 2.0, "nearest": True, "translate": [1, 0, 0]}
    media = {"m": {"absorption": 1.0, "scattering": 2.0, "density": density}}
    root, found = export(smoke, SMOKE, media=media)
    medium = root.find("medium[@type='heterogeneous']")
    assert medium is not None
    scale = medium.find("float[@name='scale']")
    assert scale is not None
    assert float(scale.get("value", "")) == pytest.approx(2 * 3 / 1000)
    albedo = medium.find("volume[@name='albedo']/spectrum[@name='value']")
    assert albedo is not None
    assert float(albedo.get("value", "")) == pytest.approx(2 / 3)
    strings = {each.get("name"): each.get("value", "") for each in medium.findall("volume/string")}
    assert strings["filter_type"] == "nearest"
    content = (found.scene.parent / strings["filename"]).read_bytes()
    assert struct.unpack_from("<3sB5i6f", content) == (b"VOL", 3, 1, 10, 10, 10, 1, 0, 0, 0, 1, 1, 1)
    # By z, y, x; one empty cell on each side.
    values = np.frombuffer(content, "<f4", offset=48).reshape(10, 10, 10)
    expected = np.zeros((10, 10, 10))
    expected[1, 1, 1], expected[2, 1, 1] = 0.5, 1.0
    np.testing.assert_array_equal(values, expected)
    matrix = medium.find("volume/transform/matrix")
    assert matrix is not None
    rows = np.array(matrix.get("value", "").split(), dtype=float).reshape(4, 4)
    np.testing.assert_allclose(rows[:3, 3], [1000 - 250, -250, -250])
    np.testing.assert_allclose(rows[:3, :3], np.diag([2500.0] * 3))


@pytest.mark.parametrize(
    ("media", "said"),
    [
        (
            {"m": {"absorption": {"table": [[400, 1], [700, 2]]}, "density": DENSITY}},
            "whose extinction depends on wavelength has no equal",
        ),
        ({"m": {"absorption": 1, "density": DENSITY}, "n": {"absorption": 1}}, "beside other media"),
    ],
)
def test_grids_without_an_equal_are_named(media: Any, said: str, smoke: Path) -> None:
    body = {**SMOKE, "interior": {"media": list(media)}}
    [problem] = refused(smoke, body, media=media)
    assert problem.startswith("$.surfaces[1].interior: ")
    assert said in problem


def test_grids_are_counted_before_they_are_read(smoke: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(volumes, "_MAX_VOXELS", 511)
    [problem] = refused(smoke, SMOKE, media={"m": {"absorption": 1, "density": DENSITY}})
    assert "more than 511 voxels" in problem


def test_depolarisation_becomes_a_part_that_is_scattered_evenly(tmp_path: Path) -> None:
    """Phase functions by both at angles: that of Bucholtz 1995, and the mix of Mitsuba's two."""
    phase = {"type": "rayleigh", "depolarisation": 0.4}
    body = {"shape": BALL, "interior": {"media": ["m"]}}
    root, _ = export(tmp_path, body, media={"m": {"scattering": 1, "phase": phase}})
    found = root.find("medium/phase[@type='blendphase']")
    assert found is not None
    assert [each.get("type") for each in found.findall("phase")] == ["rayleigh", "isotropic"]
    [even] = [float(each.get("value", "")) for each in found.findall("float")]
    square = np.linspace(0, 1, 5)
    gamma = 0.4 / 1.6
    expected = 0.75 / (1 + 2 * gamma) * (1 + 3 * gamma + (1 - gamma) * square)
    np.testing.assert_allclose((1 - even) * 0.75 * (1 + square) + even, expected, rtol=1e-6)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        (
            {
                "media": {
                    "m": {
                        "scattering": 1,
                        "phase": {
                            "type": "rayleigh",
                            "depolarisation": {"table": [[400, 0.1], [700, 0.2]]},
                        },
                    }
                },
                "unbounded_media": ["m"],
            },
            "$.unbounded_media: depolarisation that depends much on wavelength",
        ),
        (
            {"distant": [{"direction": [0, 1, 0], "angular_diameter_degrees": 170, "radiance": 1}]},
            "$.distant: a disc wider than 160 degrees",
        ),
    ],
)
def test_air_and_discs_without_an_equal_are_named(parts: Any, said: str, tmp_path: Path) -> None:
    [problem] = refused(tmp_path, **parts)
    assert problem.startswith(said)


def test_a_disc_does_not_hide_the_sky(tmp_path: Path) -> None:
    """Of a floor under both, Mitsuba saw 0.94 of the light where the disc was black."""
    disc = {"direction": [0, 1, 0], "angular_diameter_degrees": 51, "radiance": 1}
    root, _ = export(tmp_path, environment={"radiance": 0.5}, distant=[disc])
    [shape] = [each for each in root.iter("shape") if each.get("type") == "disk"]
    [bsdf] = shape.iter("bsdf")
    assert bsdf.get("type") == "null"


def test_bodies_that_may_overlap_are_refused(tmp_path: Path) -> None:
    glass = {"kernel": {"type": "dielectric", "index": 1.5}}
    other = {"type": "sphere", "centre": [1.5, 0, 0], "radius": 1}
    [problem] = refused(tmp_path, {"shape": BALL, **glass}, {"shape": other, **glass})
    assert problem.startswith("$.surfaces[2]: may overlap with $.surfaces[1]")


def _twice(shift: float) -> dict[str, Any]:
    """Two instances of a ball of glass, so far apart."""
    glass = {"shape": BALL, "kernel": {"type": "dielectric", "index": 1.5}}
    placed = [{"group": "g", "translate": [at, 0, -9]} for at in (0, shift)]
    return {"groups": {"g": [glass]}, "instances": placed}


def test_bodies_in_groups_are_exported_where_instances_stand_apart(tmp_path: Path) -> None:
    root, _ = export(tmp_path, **_twice(2.1))
    assert root.find("shape[@type='shapegroup']/shape[@type='sphere']") is not None
    [problem] = {*refused(tmp_path / "near", **_twice(1.9))}
    assert problem.startswith("$.groups: may overlap with $.groups")


@pytest.mark.parametrize(
    ("centre", "radius", "absorption", "refused_for"),
    [
        ([0.5, 0, 0.5], 0.3, 1, True),
        ([0.5, 0, 0.5], 0.3, 0, False),
        ([0, 0, 0], 9, 1, False),
        ([5, 0, 0], 1, 1, False),
    ],
    ids=["across", "clear", "wholly inside", "outside"],
)
def test_a_film_partly_in_coloured_glass_is_refused(
    centre: list[float], radius: float, absorption: float, refused_for: bool, tmp_path: Path
) -> None:
    """Mitsuba, whose sensor is in no medium, showed 7 % more of the light in a quarter of such a film."""
    glass = {"type": "dielectric", "index": 1.345} | ({"absorption": absorption} if absorption else {})
    ball = {"shape": {"type": "sphere", "centre": centre, "radius": radius}, "kernel": glass}
    meter = {
        "type": "irradiance_meter",
        "position": [0, 0, 0.5],
        "height": 1,
        "normal": [0, 0, 1],
        "up": [0, 1, 0],
    }
    if refused_for:
        [problem] = refused(tmp_path, ball, sensor=meter)
        assert problem.startswith("$.sensor: a part of its film may lie in $.surfaces[1]")
    else:
        export(tmp_path, ball, sensor=meter)


def test_the_sensor_in_an_instance_is_in_its_medium(tmp_path: Path) -> None:
    """At z = 4, in a ball of radius 0.5 about (0, 0, 8), twice as small."""
    ball = {"shape": {"type": "sphere", "centre": [0, 0, 8], "radius": 0.5}, "interior": {"media": ["m"]}}
    instance = {"group": "g", "scale": 0.5}
    root, _ = export(tmp_path, groups={"g": [ball]}, instances=[instance], media={"m": {"scattering": 1}})
    assert root.find("sensor/ref") is not None


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


def test_a_meter_stands_on_a_rectangle(tmp_path: Path) -> None:
    """Mitsuba's first row is that of its lowest y, ours the highest: x is right, y down, z the normal."""
    sensor = {"type": "irradiance_meter", "position": [0, 0, 0.5], "normal": [0, 0, 1], "up": [0, 1, 0]}
    root, _ = export(tmp_path, sensor={**sensor, "height": 0.3})
    found = root.find("shape/sensor[@type='irradiancemeter']/..")
    assert found is not None
    assert [each.get("type") for each in found.findall("bsdf")] == ["null"]
    rows = found.find("transform/matrix")
    assert rows is not None
    matrix = np.array(rows.get("value", "").split(), dtype=float).reshape(4, 4)
    # Who looks along z with y up has -x on the right. One metre is 1000 units; the film has 40 x 30 pixels.
    expected = [[-200, 0, 0, 0], [0, -150, 0, 0], [0, 0, 1, 500], [0, 0, 0, 1]]
    np.testing.assert_allclose(matrix, expected, atol=1e-9)


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
