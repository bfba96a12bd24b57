"""Whether pilots let neighbours share where that is worth 7 times the time (docs/decisions/0115)."""

from pathlib import Path

import pytest

from bench.peer.planes import planes
from bench.scenes import compile_film, example

_ALONE = {"direction": "adjoint", "guide": "none"}


@pytest.mark.parametrize(("samples", "seed"), [(1024, 1), (2048, 1), (2048, 3)])
def test_a_few_dark_corners_do_not_decide(samples: int, seed: int, tmp_path: Path) -> None:
    """Squares at the wall's edge are as noisy by both methods. With larger ones none of these was shared."""
    document = {**planes(tmp_path), "tracing": {**_ALONE, "seed": seed}}
    assert "shared" in compile_film(document, tmp_path, 128, 96, samples).way


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_few_pixels_decide_where_their_gain_is_sure(seed: int, tmp_path: Path) -> None:
    """768 pixels of a Cornell box, where sharing is worth 1.9: who asks for 2 of so few never takes it."""
    document = {**example("cornell", tmp_path), "tracing": {"seed": seed}}
    assert "shared" in compile_film(document, tmp_path, 48, 32, 512).way
