"""`nocturne validate` from end to end, of one quick suite."""

import json
import re
from pathlib import Path
from typing import get_type_hints

import pytest
from nocturne_client.cli.app import app
from nocturne_client.cli.validate_command import validate
from nocturne_scene.validation import lamps
from nocturne_scene.validation.suites import SUITES
from typer.testing import CliRunner

pytestmark = pytest.mark.system


def test_a_suite_is_rendered_and_told(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    done = CliRunner().invoke(app, ["validate", "lamps", "--quick", "--json", "--page", str(page)])
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    names = [scene.values[0].name for scene in list(lamps.scenes())[::8]]
    assert [each["name"] for each in told["values"]] == names
    assert told["verdict"]["good"]
    assert told["engine"] > 0
    for each in told["values"]:
        assert each["value"] == pytest.approx(each["truth"], rel=0.01)
        assert each["z"] == pytest.approx((each["value"] - each["truth"]) / each["standard_error"])
        assert 1.9 < each["half_interval_95"] / each["standard_error"] < 2.1
        assert each["source"]
    html = page.read_text()
    assert all(name in html for name in names)
    # Nothing is fetched.
    assert not re.search(r"(src|href)=", html)


def test_the_same_seed_has_the_same_bits() -> None:
    """However many scenes are rendered at once."""
    values = []
    for threads in ("1", "2"):
        done = CliRunner().invoke(app, ["validate", "lamps", "--quick", "--json", "--threads", threads])
        values.append(json.loads(done.stdout)["values"])
    assert values[0] == values[1]


def test_no_such_suite() -> None:
    done = CliRunner().invoke(app, ["validate", "cie172"])
    assert done.exit_code != 0
    assert "no suite named cie172; expected one of cie171" in str(done.exception)


def test_help_names_all_suites() -> None:
    """It is a list of its own: the suites are long to import."""
    [argument] = get_type_hints(validate, include_extras=True)["suites"].__metadata__
    assert argument.help == f"{', '.join(suite.name for suite in SUITES)}; all without."
