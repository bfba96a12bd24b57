"""`nocturne import` and `nocturne compare`, as people call them."""

import json
from pathlib import Path

import numpy as np
import pytest
from nocturne_client.cli.app import app
from nocturne_client.errors import NocturneClientError
from typer.testing import CliRunner

from tests.pictures import write_exr

SCENE = """<scene version="3.0.0">
<sensor type="perspective"><float name="fov" value="40"/>
  <film type="hdrfilm"><integer name="width" value="$size"/><integer name="height" value="9"/></film></sensor>
<emitter type="point"><rgb name="intensity" value="1"/></emitter>
<shape type="sphere">{bsdf}</shape>
</scene>"""


@pytest.fixture
def runner() -> CliRunner:
    return CliRunner()


def test_import_says_what_it_changed_and_how_to_render(runner: CliRunner, tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(SCENE.format(bsdf=""))
    command = ["import", str(tmp_path / "a.xml"), "-o", str(tmp_path / "out"), "-D", "size=16"]
    found = runner.invoke(app, [*command, "--light-radius", "0.5"])
    assert found.exit_code == 0
    assert found.stdout == f"{tmp_path / 'out' / 'scene.json'}\n"
    assert "a sphere of radius 0.5 m" in found.stderr
    assert "--width 16 --height 9" in found.stderr
    assert json.loads((tmp_path / "out" / "scene.json").read_text())["nocturne"] == 1


def test_import_names_what_is_missing(runner: CliRunner, tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(SCENE.format(bsdf='<bsdf type="hair"/>'))
    command = ["import", str(tmp_path / "a.xml"), "-o", str(tmp_path / "out"), "-D", "size=16"]
    found = runner.invoke(app, command)
    assert isinstance(found.exception, NocturneClientError)
    assert "--allow-missing" in str(found.exception)
    assert found.exception.problems[0].place == "a.xml:5"
    found = runner.invoke(app, [*command, "--allow-missing"])
    assert found.exit_code == 0
    assert 'missing: a.xml:5: no support for the bsdf "hair"' in found.stderr


def test_compare_by_the_variance_of_one_sample(runner: CliRunner, tmp_path: Path) -> None:
    """Of 100 samples a mean has a tenth of one sample's deviation; 5 % of it everywhere is z = 24 in sum."""
    noise = 0.1 * np.random.default_rng(1).standard_normal((48, 48, 3))
    image = write_exr(tmp_path / "a.exr", 1 + noise)
    darker = write_exr(tmp_path / "c.exr", 0.95 + noise)
    reference = write_exr(tmp_path / "b.exr", np.ones((48, 48, 3)))
    variance = write_exr(tmp_path / "v.exr", np.ones((48, 48, 3)))
    options = ["--variance", str(variance), "--samples", "100", "--json"]
    same = runner.invoke(app, ["compare", str(image), str(reference), *options])
    other = runner.invoke(app, ["compare", str(darker), str(reference), *options])
    assert (same.exit_code, other.exit_code) == (0, 1)
    assert json.loads(same.stdout)["share_explained"] > 0.9975
    assert json.loads(other.stdout)["mean_z"][1] == pytest.approx(-24, abs=3)
    scaled = runner.invoke(app, ["compare", str(darker), str(reference), *options, "--scale", "1.0526"])
    assert scaled.exit_code == 0


def test_compare_with_an_image_that_does_not_state_its_errors(runner: CliRunner, tmp_path: Path) -> None:
    """As images of other renderers: their noise is no difference, and a factor of 5 % is one."""
    random = np.random.default_rng(2)
    ours, theirs = (1 + 0.05 * random.standard_normal((48, 48, 3)) for _ in range(2))
    channels = np.concatenate([ours, np.full((48, 48, 1), 0.05)], axis=-1)
    image = write_exr(tmp_path / "a.exr", channels, ("X", "Y", "Z", "Y.stderr"))
    reference = write_exr(tmp_path / "b.exr", theirs)
    same = runner.invoke(app, ["compare", str(image), str(reference)])
    assert same.exit_code == 0, same.stdout
    assert f"{reference} does not state its errors" in same.stdout
    assert "means agree" in same.stdout
    other = runner.invoke(app, ["compare", str(image), str(reference), "--scale", "1.05", "--json"])
    assert other.exit_code == 1
    found = json.loads(other.stdout)
    assert found["without_errors"] == str(reference)
    assert found["mean_z"][0] > 10
    assert found["explained"] == pytest.approx(0.0025 / (2 * 0.0025 + 0.0025), abs=0.1)


def test_compare_without_noise_says_so(runner: CliRunner, tmp_path: Path) -> None:
    image = write_exr(tmp_path / "a.exr", np.full((8, 8, 3), 1.1), "RGB")
    reference = write_exr(tmp_path / "b.exr", np.ones((8, 8, 3)), "RGB")
    command = ["compare", str(image), str(reference), "--difference", str(tmp_path / "d.png")]
    found = runner.invoke(app, command)
    assert found.exit_code == 0
    assert "mean Y: +10.000%" in found.stdout
    assert "neither file tells its noise" in found.stdout
    assert (tmp_path / "d.png").is_file()
