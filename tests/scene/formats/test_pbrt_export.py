"""Documents as scenes of pbrt's: the written features, those that are refused by name, and the reimport.

pbrt itself does not run. The exported file is read by Nocturne's importer, whose own tests are about pbrt's
documented conventions; conventions that both could have equally wrong are tested here by numbers.
"""

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.exporting import export_to
from nocturne_client.local.programs import CHECKOUT, need_program
from nocturne_scene.compare.images import read_picture
from nocturne_scene.film import Film
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.pbrt import squares
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.spectra.published import observer, visible_wavelengths

from tests.mitsuba.export_scenes import SCENES

LAMP = {
    "shape": {"type": "quad", "corner": [-1, 3, -1], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2]},
    "kernel": {"type": "lambertian", "reflectance": 0.0},
    "luminaire": {"radiance": {"blackbody": 3500, "luminance": 5000}},
}
BALL = {"type": "sphere", "centre": [1, 2, 3], "radius": 0.5}
SENSOR = {
    "type": "pinhole",
    "position": [0, 0, 4],
    "look_at": [0, 0, 0],
    "vertical_field_of_view_degrees": 40,
}


def export(tmp_path: Path, *surfaces: Any, film: Film | None = None, **parts: Any) -> str:
    document = {"nocturne": 1, "sensor": SENSOR, "surfaces": [LAMP, *surfaces], **parts}
    (tmp_path / "scene.json").write_text(json.dumps(document))
    found = export_to(tmp_path / "scene.json", tmp_path / "out", "pbrt", film or Film(40, 30, 16))
    return found.scene.read_text()


def numbers(text: str, name: str, after: str = "") -> list[float]:
    """Of the first parameter of that name behind some words."""
    found = re.search(rf'"\w+ {name}" \[ ([^\]]*) \]', text[text.index(after) :])
    assert found is not None
    return [float(word) for word in found[1].split()]


def image(document: Path, folder: Path) -> Any:
    """Few samples with the document's seed: XYZ."""
    compiled = compile_to(document, folder, 24, 18, 16)
    command: list[str | Path] = [
        need_program("nocturne-trace"),
        compiled.scene,
        "--schedule",
        compiled.schedule,
    ]
    command += ["--blobs", compiled.blobs, "-o", folder / "image.exr", "--quiet"]
    subprocess.run(command, check=True)
    return read_picture(folder / "image.exr").xyz


def scene(name: str, folder: Path) -> Path:
    if name not in SCENES:
        return CHECKOUT / "examples" / name / "scene.json"
    (folder / "scene.json").write_text(json.dumps(SCENES[name](folder)))
    return folder / "scene.json"


@pytest.mark.parametrize(
    "name", ["dyed_glass", "everywhere", "instances", "cornell", "colour_chart", "subsurface"]
)
def test_what_comes_back_is_the_same_image(name: str, tmp_path: Path) -> None:
    """With the same seed, photon by photon."""
    document = scene(name, tmp_path)
    exported = export_to(document, tmp_path / "out", "pbrt", Film(24, 18, 16))
    back = import_scene(exported.scene, tmp_path / "back", ImportOptions())
    assert (back.missing, back.film.width, back.film.height, back.film.samples) == ([], 24, 18, 16)
    given, found = image(document, tmp_path / "given"), image(back.document, tmp_path / "found")
    assert given.mean() > 0
    assert np.abs(found - given).max() < 1e-4 * given.mean()


@pytest.mark.parametrize(
    ("kernel", "said"),
    [
        ({"type": "phong", "reflectance": 0.5, "exponent": 10}, "the kernel phong"),
        ({"type": "thin_pane", "index": 1.5, "transmittance": 0.5}, "a pane that absorbs"),
        (
            {"type": "conductor", "index": "Ag", "coating": [{"index": 1.5, "thickness_nm": 90}]},
            "a coating has no equal in pbrt",
        ),
        ({"type": "glazing", "panes": [{"index": 1.5}]}, "the kernel glazing has no equal in pbrt"),
        (
            {"type": "conductor", "index": "Ag", "roughness": 0.2, "distribution": "beckmann"},
            "facets by Beckmann",
        ),
        (
            {
                "type": "two_sided",
                "front": {"type": "conductor", "index": "Ag"},
                "back": {"type": "lambertian", "reflectance": 0.5},
            },
            "two different sides",
        ),
    ],
)
def test_kernels_without_an_equal_are_named(kernel: Any, said: str, tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError) as raised:
        export(tmp_path, {"shape": BALL, "kernel": kernel})
    [problem] = [str(each) for each in raised.value.problems]
    assert problem.startswith("$.surfaces[1].kernel: ")
    assert said in problem
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("phase", "said"),
    [
        ({"type": "rayleigh"}, "phase functions other than"),
        ({"type": "double_henyey_greenstein", "first": 0.5, "second": -0.2, "weight": 0.5}, "other than"),
    ],
)
def test_phase_functions_without_an_equal_are_named(phase: Any, said: str, tmp_path: Path) -> None:
    body = {"shape": BALL, "interior": {"media": ["m"]}}
    with pytest.raises(NocturneClientError) as raised:
        export(tmp_path, body, media={"m": {"scattering": 1, "phase": phase}})
    assert said in str(raised.value.problems[0])


def test_light_is_told_by_its_luminance(tmp_path: Path) -> None:
    """pbrt divides by the sum over whole nm of the table times y, and multiplies by the scale: 5000 cd/m2."""
    text = export(tmp_path)
    assert numbers(text, "scale", "AreaLightSource") == [pytest.approx(5000, rel=1e-4)]
    table = np.array(numbers(text, "L", "AreaLightSource")).reshape(-1, 2)
    at = visible_wavelengths()
    shape = np.interp(at, *table.T)
    y = observer("CIE 1931 2 degree")[:, 1]
    # Planck at 3500 K, relative to 560 nm.
    planck = (at / 560) ** -5 * np.expm1(1.438776877e7 / (560 * 3500)) / np.expm1(1.438776877e7 / (at * 3500))
    assert shape / (shape @ y) == pytest.approx(planck / (planck @ y), rel=2e-3)


@pytest.mark.parametrize(("width", "height", "degrees"), [(40, 30, 40.0), (20, 40, 20.63)])
def test_the_field_of_view_is_that_of_the_shorter_side(
    width: int, height: int, degrees: float, tmp_path: Path
) -> None:
    """2 atan(tan(20 degrees) / 2) = 20.63 degrees."""
    text = export(tmp_path, film=Film(width, height, 1))
    assert numbers(text, "fov") == [pytest.approx(degrees, abs=0.01)]


def test_the_camera_has_x_to_its_right_and_z_ahead(tmp_path: Path) -> None:
    """From (0, 0, 4) towards -z with y up, +x of a right-handed world is on the right."""
    [line] = [line for line in export(tmp_path).split("\n") if line.startswith("Transform ")]
    matrix = np.array([float(word) for word in line.split()[2:-1]]).reshape(4, 4).T
    assert matrix @ [1, 0, 4, 1] == pytest.approx([1, 0, 0, 1])
    assert matrix @ [0, 1, 4, 1] == pytest.approx([0, 1, 0, 1])
    assert matrix @ [0, 0, 3, 1] == pytest.approx([0, 0, 1, 1])


def test_masks_and_blends(tmp_path: Path) -> None:
    """A mask is an opacity of the shape; a mix's amount is that of its second material."""
    blend = {
        "type": "blend",
        "first": {"type": "lambertian", "reflectance": 0.25},
        "second": {"type": "conductor", "index": "Au", "roughness": 0.3},
        "weight": 0.125,
    }
    text = export(tmp_path, {"shape": BALL, "kernel": {"type": "mask", "kernel": blend, "opacity": 0.75}})
    assert numbers(text, "alpha", 'Shape "sphere"') == [0.75]
    assert numbers(text, "amount") == [0.125]
    names = re.search(r'"string materials" \[ "(\w+)" "(\w+)" \]', text)
    assert names is not None
    kinds = [re.search(rf'MakeNamedMaterial "{name}" "string type" "(\w+)"', text) for name in names.groups()]
    assert [kind[1] for kind in kinds if kind] == ["diffuse", "conductor"]
    assert numbers(text, "uroughness") == [pytest.approx(0.3)]
    assert '"bool remaproughness" false' in text


def test_bodies_know_what_is_on_both_sides(tmp_path: Path) -> None:
    body = {"shape": BALL, "kernel": {"type": "dielectric", "index": 1.5}, "interior": {"media": ["m"]}}
    haze = {"scattering": 0.1, "phase": {"type": "henyey_greenstein", "g": 0.5}}
    text = export(tmp_path, body, media={"m": {"absorption": 2}, "haze": haze}, unbounded_media=["haze"])
    [inside, outside] = re.findall(r'MakeNamedMedium "(\w+)"[^\n]*"float g" \[ 0 \]', text) + re.findall(
        r'MakeNamedMedium "(\w+)"[^\n]*"float g" \[ 0.5 \]', text
    )
    camera, ball = re.findall(r'MediumInterface "(\w*)" "(\w*)"', text)
    assert camera == ("", outside)
    assert ball == (inside, outside)
    assert numbers(text, "sigma_a", f'MakeNamedMedium "{inside}"')[1::2] == [2, 2]
    assert not any(numbers(text, "sigma_s", f'MakeNamedMedium "{inside}"')[1::2])


def test_squares_keep_areas() -> None:
    """Of any cap of the sphere, the part of the square is that of the sphere (Clarberg 2008)."""
    middle = (np.arange(512) + 0.5) / 512
    found = squares.direction(*np.meshgrid(middle, middle)).reshape(-1, 3)
    assert np.linalg.norm(found, axis=1) == pytest.approx(1)
    generator = np.random.default_rng(5)
    for axis in generator.normal(size=(20, 3)):
        height = generator.uniform(-0.9, 0.9)
        part = np.mean(found @ (axis / np.linalg.norm(axis)) > height)
        assert part == pytest.approx((1 - height) / 2, abs=2e-3)


def test_squares_have_z_in_the_middle_and_x_and_y_along_their_sides() -> None:
    u, v = np.array([0.5, 1.0, 0.5, 0.0, 0.5, 0.0, 1.0]), np.array([0.5, 0.5, 1.0, 0.5, 0.0, 0.0, 1.0])
    expected = [[0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, -1], [0, 0, -1]]
    assert squares.direction(u, v) == pytest.approx(np.array(expected), abs=1e-12)


def test_places_on_squares_are_those_of_directions() -> None:
    u, v = np.random.default_rng(6).uniform(size=(2, 10_000))
    again = squares.place(squares.direction(u, v))
    assert np.abs(again[0] - u).max() < 1e-7
    assert np.abs(again[1] - v).max() < 1e-7


def test_a_sky_keeps_its_light_and_comes_back() -> None:
    rows, columns = 32, 64
    polar = np.arccos(1 - 2 * (np.arange(rows) + 0.5) / rows)[:, None]
    azimuth = np.pi * (1 - 2 * (np.arange(columns) + 0.5) / columns)
    smooth = 1 + np.sin(polar) * np.cos(azimuth - 0.5) / 2 + np.cos(polar) / 3
    texels = np.stack([smooth, smooth**2, np.ones_like(smooth)], axis=-1)
    square = squares.equal_area_square(texels)
    assert square.mean(axis=(0, 1)) == pytest.approx(texels.mean(axis=(0, 1)), rel=1e-4)
    back = squares.latitudes(square.astype(np.float32))
    height, width = back.shape[:2]
    for row, column in ((5, 7), (16, 40), (29, 60)):
        at = int(height * polar[row, 0] / np.pi), int(width * (column + 0.5) / columns)
        assert back[at] == pytest.approx(texels[row, column], rel=0.03)
