"""Whether pilots let neighbours share where that is worth 7 times the time (docs/decisions/0115)."""

from pathlib import Path

import pytest

from bench.peer.planes import planes
from bench.scenes import compile_film

_ALONE = {"direction": "adjoint", "guide": "none"}


@pytest.mark.parametrize(("samples", "seed"), [(1024, 1), (2048, 1), (2048, 3)])
def test_a_few_dark_corners_do_not_decide(samples: int, seed: int, tmp_path: Path) -> None:
    """Squares at the wall's edge are as noisy by both ways. With larger ones none of these was shared."""
    document = {**planes(tmp_path), "tracing": {**_ALONE, "seed": seed}}
    assert "shared" in compile_film(document, tmp_path, 128, 96, samples).way
