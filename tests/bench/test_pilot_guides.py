"""Whether pilots keep a guide that light is met by."""

from pathlib import Path

import pytest

from bench.scenes import compile_film
from bench.trap_scenes import TRAPS


@pytest.mark.parametrize("seed", [3, 5])
def test_a_bright_sample_does_not_hide_what_a_guide_brings(seed: int, tmp_path: Path) -> None:
    """A lamp over the water of a pool: guided photons meet twice the light, and images without them have 30
    times the error for the same time. One bright sample of those that are not guided made both look alike.
    """
    document = {**TRAPS["pool"](), "tracing": {"seed": seed}}
    assert "guided by what was learned" in compile_film(document, tmp_path, 48, 32, 512).way
