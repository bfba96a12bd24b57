"""The Cornell box: methods that must give the same image do.

Compared images have independent random numbers of different seeds, so that standard errors are right; those
of Sobol points are too large, which hides faults. With 8192 and 4096 samples the darkest pixels' sums of Y
have twenty or more contributions that matter, the typical ones hundreds: near enough to normal for single
pixels (12 of 12 other seeds passed, their largest |z| 3.9). With fewer, in `make test`, means and tiles are
compared.
"""

from pathlib import Path
from typing import Any

import pytest

from tests.accuracy.agreement import compare
from tests.accuracy.scenes import cornell
from tests.accuracy.tracing import IN_FULL, Document, part_of, trace
from tests.system.images import Image

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_EDGE = 16


def _independent(seed: int, **tracing: Any) -> Document:
    return {"sequence": "independent", "seed": seed, **tracing}


@pytest.fixture(scope="module")
def adjoint(tmp_path_factory: pytest.TempPathFactory) -> Image:
    """A long run with the default method, but independent sampling."""
    return trace(cornell(_independent(1)), tmp_path_factory.mktemp("adjoint"), _EDGE, part_of(8192))


def test_agrees_with_path_tracing(adjoint: Image, tmp_path: Path) -> None:
    """Explicit direct light, kernel sampling: another method for the same image."""
    path = trace(cornell(_independent(2)), tmp_path, _EDGE, part_of(4096), "path")
    compared = compare(path, adjoint)
    if IN_FULL:
        compared.check()
    else:
        compared.check_mean_and_tiles()


def test_sobol_has_the_same_mean(adjoint: Image, tmp_path: Path) -> None:
    """Within 3 standard errors; false alarms below 0.003."""
    image = trace(cornell({}), tmp_path, _EDGE, 1024)
    assert abs(compare(image, adjoint).mean) < 3.0


@pytest.mark.parametrize(
    "document",
    [
        pytest.param(cornell(_independent(3), wavelengths="uniform"), id="uniform wavelengths"),
        pytest.param(cornell(_independent(4, h=0.6)), id="fewer survive"),
        pytest.param(cornell(_independent(5, h=1.5)), id="more survive"),
        pytest.param(cornell(_independent(6, roulette="albedo")), id="roulette by albedo"),
        pytest.param(
            cornell(
                _independent(
                    7, estimator="mixture", mixture={"kernel": 0.3, "luminaires": 0.3, "uniform": 0.4}
                )
            ),
            id="mixture",
        ),
        pytest.param(cornell(_independent(9, estimator="split", split_vertices=2)), id="split"),
        pytest.param(cornell(_independent(10, photons_together=1)), id="alone"),
        pytest.param(
            cornell(_independent(8), type="thin_lens", lens_radius=1e-5, focus_distance=1.0), id="tiny lens"
        ),
    ],
)
def test_a_choice_changes_the_noise_only(document: Document, adjoint: Image, tmp_path: Path) -> None:
    """z of the mean and of tiles; false alarms: 0.013 for each choice."""
    image = trace(document, tmp_path, _EDGE, 1024)
    compare(image, adjoint).check_mean_and_tiles()
