"""`nocturne render`: seeds, statistics, stops and its last lines, by the real tracer."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenEXR
import pytest
from nocturne_client import NocturneClientError
from nocturne_client.cli.app import app
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.image_error import image_error
from nocturne_client.local.local_stop import LocalStop
from nocturne_client.local.render import LocalRender, render_scene
from nocturne_scene.render_warnings import header_lines
from typer.testing import CliRunner

from tests.pictures import read_pixels
from tests.scene.formats.mitsuba_import import SENSOR

ROOT = Path(__file__).parents[2]
GLASS_BALL = ROOT / "examples" / "pbrt" / "glass_ball.pbrt"
LAMP: dict[str, Any] = {
    "nocturne": 1,
    "sensor": {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 1, 0], "height": 0.1},
    "surfaces": [
        {
            "shape": {"type": "disc", "centre": [0, 2, 0], "normal": [0, -1, 0], "radius": 1},
            "kernel": {"type": "lambertian", "reflectance": 0},
            "luminaire": {"radiance": {"illuminant": "A"}, "lumens": 800},
        }
    ],
}
MIRROR: dict[str, Any] = {
    "nocturne": 1,
    "sensor": {
        "type": "pinhole",
        "position": [0, 0, -2],
        "look_at": [0, 0, 0],
        "vertical_field_of_view_degrees": 40,
    },
    "environment": {"radiance": 0.05},
    "tracing": {"direction": "adjoint", "sharing": 1, "guide": "none"},
    "surfaces": [
        {
            "shape": {"type": "quad", "corner": [-5, -5, 1], "edge_u": [0, 10, 0], "edge_v": [10, 0, 0]},
            "kernel": {"type": "conductor", "index": "Ag"},
        },
        {
            "shape": {"type": "sphere", "centre": [0.9, 0.6, -3], "radius": 5e-4},
            "kernel": {"type": "lambertian", "reflectance": 0},
            "luminaire": {"radiance": 1e7},
        },
    ],
}
AXIS = 800 / math.pi / (1 + 4)
"""Illuminance on the axis of a diffuse disc: flux / area times r^2 / (r^2 + d^2)."""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(LAMP))
    return path


def rendered(scene: Path, *options: str, name: str = "image.exr", size: int = 8) -> tuple[Path, str]:
    output = scene.with_name(name)
    film = ["--width", str(size), "--height", str(size), "--threads", "2"]
    result = CliRunner().invoke(app, ["render", str(scene), "-o", str(output), *film, *options])
    assert result.exit_code == 0, result.output
    return output, result.stderr


def channels(path: Path) -> dict[str, npt.NDArray[Any]]:
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.copy() for name, channel in file.channels().items()}


def test_what_the_image_may_not_show_is_told_and_in_its_header(tmp_path: Path) -> None:
    """A lamp of a millimetre that shows in a mirror. The tracer writes it as the service does."""
    scene = tmp_path / "mirror.json"
    scene.write_text(json.dumps(MIRROR))
    image, said = rendered(scene, "--samples", "16", size=64)
    warnings = compile_to(scene, tmp_path, 64, 64, 16).warnings
    assert [each.kind for each in warnings] == ["missing_in_parts"]
    [line] = [line for line in said.splitlines() if line.startswith("warning: ")]
    assert line == f"warning: {warnings[0].sentence}"
    with OpenEXR.File(str(image)) as file:
        header = {name: value for name, value in file.header().items() if name.startswith("nocturne:")}
    lines = header_lines(warnings)
    assert lines
    assert {name: header[name] for name in lines} == lines
    assert "nocturne:way" not in header


def test_a_seed_changes_the_samples_and_nothing_else(scene: Path) -> None:
    once, again, other = (
        channels(rendered(scene, "--samples", "64", "--seed", seed, name=f"{name}.exr")[0])
        for name, seed in (("a", "7"), ("b", "7"), ("c", "8"))
    )
    assert all(np.array_equal(once[name], again[name]) for name in once)
    assert not np.array_equal(once["Y"], other["Y"])


def test_an_error_that_is_never_met_gives_the_bits_of_all_samples(scene: Path) -> None:
    """Ranges of the whole film, asked after each, are the same work as tiles one after the other."""
    all_at_once = channels(rendered(scene, "--samples", "100")[0])
    by_ranges = channels(rendered(scene, "--samples", "100", "--error", "0.0001%", name="b.exr")[0])
    assert all(np.array_equal(all_at_once[name], by_ranges[name]) for name in all_at_once)


def test_an_error_ends_it_at_the_end_of_a_range(scene: Path) -> None:
    image, said = rendered(scene, "--samples", "65536", "--error", "10%")
    samples = channels(image)["n"]
    assert samples.min() == samples.max() < 65536
    found = image_error(image)
    assert found.error_warning == ""
    assert 0.0 < found.estimate.relative_error <= 0.1
    assert abs(found.estimate.mean - AXIS) < 4 * found.estimate.mean_error
    assert "mean illuminance" in said
    assert " lx, u' 0." in said
    assert " (95 %)" in said
    assert "10.000% was asked for" in said


def test_one_sample_gives_no_error(scene: Path) -> None:
    _, said = rendered(scene, "--samples", "1")
    assert "one sample per pixel gives no error" in said
    assert "0.000%" not in said


def test_a_film_of_no_pixels_is_refused_by_the_name_of_the_file_that_was_imported(tmp_path: Path) -> None:
    command = ["render", str(GLASS_BALL), "-o", str(tmp_path / "a.exr"), "--samples", "1"]
    for film in (["--width", "0"], ["--height", "0"]):
        result = CliRunner().invoke(app, [*command, *film])
        assert result.exit_code != 0
        assert str(result.exception) == f"{GLASS_BALL} can't be rendered"


def test_a_time_ends_it(scene: Path) -> None:
    image, _ = rendered(scene, "--samples", "1000000", "--for", "1 s")
    assert channels(image)["n"].max() < 1_000_000


def test_statistics_are_written(scene: Path) -> None:
    rendered(scene, "--samples", "16", "--statistics", str(scene.with_name("s.json")))
    found = json.loads(scene.with_name("s.json").read_text())
    assert found["invalid_samples"] == 0
    assert found["rays"] > 0


def test_the_name_says_which_picture_it_is(scene: Path) -> None:
    """An EXR, and a PNG whose grey is what a preview shows; of an even image, middle grey of 18 %."""
    images = [scene.with_name(name) for name in ("a.exr", "b.PNG", "c.exr")]
    film = ["--width", "8", "--height", "8", "--samples", "1024", "--threads", "2"]
    asked = [word for image in images for word in ("-o", str(image))]
    result = CliRunner().invoke(app, ["render", str(scene), *asked, *film])
    assert result.exit_code == 0, result.output
    assert result.stdout.split() == [str(image) for image in images]
    assert images[0].read_bytes() == images[2].read_bytes()
    assert images[1].read_bytes().startswith(b"\x89PNG")
    assert set(channels(images[0])) >= {"X", "Y", "Z"}
    pixels = read_pixels(images[1])
    assert pixels.shape == (8, 8, 3)
    assert 0.3 < pixels.mean() < 0.6


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("image.txt", "expected a name that ends in .exr or .png"),
        ("image", "expected a name that ends in .exr or .png"),
        ("no/such/image.exr", "no such folder"),
        ("folder", "is a folder"),
        ("/proc/image.exr", "can't be written"),
    ],
)
@pytest.mark.parametrize("option", ["-o", "--statistics"])
def test_what_can_not_be_written_is_refused_before_tracing(
    scene: Path, name: str, said: str, option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if option == "--statistics" and "expected" in said:
        pytest.skip("statistics may have any name")
    monkeypatch.setattr("nocturne_client.local.render.compile_to", None)
    (scene.parent / "folder").mkdir()
    outputs = {"-o": str(scene.with_name("image.exr")), option: str(scene.parent / name)}
    words = [word for pair in outputs.items() for word in pair]
    result = CliRunner().invoke(app, ["render", str(scene), *words])
    assert isinstance(result.exception, NocturneClientError)
    assert said in str(result.exception)


def test_an_image_that_can_not_be_written_in_the_end_is_kept(scene: Path) -> None:
    """/dev/full takes nothing."""
    with pytest.raises(NocturneClientError, match="No space left on device; the image is kept as") as caught:
        render_scene(LocalRender(scene, [Path("/dev/full")], 8, 8, 4, 1))
    kept = Path(str(caught.value).rpartition(" ")[2])
    assert set(channels(kept)) >= {"X", "Y", "Z"}
    kept.unlink()
    kept.parent.rmdir()


def test_no_light_is_told(scene: Path) -> None:
    dark = {**LAMP, "sensor": {**LAMP["sensor"], "normal": [0, -1, 0]}}
    scene.write_text(json.dumps(dark))
    assert "No light was found" in rendered(scene)[1]


@pytest.mark.parametrize("options", [("--for", "8"), ("--for", "0 s"), ("--error", "0"), ("--error", "0%")])
def test_numbers_without_a_unit_or_a_sense_are_refused(scene: Path, options: tuple[str, str]) -> None:
    result = CliRunner().invoke(app, ["render", str(scene), "-o", str(scene.with_name("a.exr")), *options])
    assert result.exit_code == 2
    assert options[1] in result.stderr


def test_another_picture_has_no_error_to_tell(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(b"no image")
    with pytest.raises(NocturneClientError, match="is no EXR of ours"):
        image_error(tmp_path / "a.exr")


def test_the_image_of_another_range_says_so(scene: Path) -> None:
    """A mercury lamp that visible light knows nothing of, in the tracer's own words and in ours."""
    lamp = {"luminaire": {"watts": 10, "radiance": {"lines": [{"nm": 253.65, "power": 1}]}}}
    surfaces = [{**each, **lamp} if "luminaire" in each else each for each in LAMP["surfaces"]]
    sensor = {**LAMP["sensor"], "measures": "actinic", "named_responses": ["photons"]}
    within = {"wavelengths": {"first": 200, "last": 300}}
    scene.write_text(json.dumps({**LAMP, **within, "surfaces": surfaces, "sensor": sensor}))
    image, _ = rendered(scene, "--samples", "64")
    with OpenEXR.File(str(image), separate_channels=True) as file:
        header = file.header()
        found = (header["nocturne:quantity"], header["nocturne:unit"], header["nocturne:wavelengths"])
        assert found == ("actinic irradiance", "W m-2", "200 to 300 nm")
    found_error = image_error(image)
    assert "actinic irradiance of 200 to 300 nm" in str(found_error)
    assert "u'" not in str(found_error)
    # A disc of 10 W at two radii, straight above: 10 / pi / (1 + 4) W/m2, weighed by ICNIRP's 0.43 at 250 nm
    # and 0.5 at 254 nm.
    weight = 0.43 * (0.5 / 0.43) ** (3.65 / 4)
    assert found_error.estimate.mean == pytest.approx(2 / np.pi * weight, rel=0.02)


@pytest.mark.parametrize(
    ("sensor", "quantity", "unit"),
    [("irradiance_meter", "illuminance", "lx"), ("pinhole", "luminance", "cd/m2")],
)
def test_the_image_of_the_tracer_knows_its_quantity(
    scene: Path, sensor: str, quantity: str, unit: str
) -> None:
    """As nocturne_scene/quantities.py has it: the tracer's own table says the same."""
    pinhole = {"type": "pinhole", "position": [0, 0, 0], "look_at": [0, 1, 0], "up": [0, 0, 1]}
    if sensor == "pinhole":
        changed = {**LAMP, "sensor": {**pinhole, "vertical_field_of_view_degrees": 30}}
        scene.write_text(json.dumps(changed))
    image, _ = rendered(scene, "--samples", "4")
    with OpenEXR.File(str(image), separate_channels=True) as file:
        header = file.header()
        assert (header["nocturne:quantity"], header["nocturne:unit"]) == (quantity, unit)
        assert ("whiteLuminance" in header) == (quantity == "luminance")
    assert image_error(image).quantity.unit == unit


def test_a_scene_of_another_renderer_is_rendered_with_its_film(tmp_path: Path) -> None:
    shape = '<shape type="sphere"><emitter type="area"/></shape><shape type="nonsense"/>'
    scene = tmp_path / "ball.xml"
    scene.write_text(f'<scene version="3.0.0">{SENSOR}{shape}</scene>')
    asked = ["render", str(scene), "-o", str(tmp_path / "ball.exr"), "--samples", "4", "--threads", "2"]
    refused = CliRunner().invoke(app, asked)
    assert refused.exit_code != 0
    assert "--allow-missing" in str(refused.exception) + refused.output
    done = CliRunner().invoke(app, [*asked, "--allow-missing"])
    assert done.exit_code == 0, done.output
    assert "missing: ball.xml:" in done.stderr
    assert channels(tmp_path / "ball.exr")["Y"].shape == (20, 40)


def test_what_fails_between_ranges_ends_the_render(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scene: Path
) -> None:
    """The program asks after each range, and would wait for an answer without end."""

    def fail(*_: object) -> bool:
        raise ValueError("sums that nobody can read")

    monkeypatch.setattr(LocalStop, "is_met", fail)
    asked = LocalRender(scene, [tmp_path / "a.exr"], 16, 16, 64, 1, stop={"relative_error": 0.1})
    with pytest.raises(ValueError, match="nobody can read"):
        render_scene(asked)
