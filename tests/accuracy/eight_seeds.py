"""Means of a scene by eight seeds, compared by Student's t with the errors that these tell."""

from pathlib import Path

from nocturne_client.local.compiled import compile_to
from scipy import stats

from tests.accuracy.tracing import Document, part_of, run_seeds, write

_SEEDS = 8
_PLAIN = {"sequence": "independent", "sharing": 1, "guide": "none", "direction": "adjoint"}


def means(document: Document, folder: Path, samples: int = 512, **tracing: object) -> list[float]:
    """Of Y of 16 x 16 pixels, by each seed; a part of the samples in `make test`. `folder` is made."""
    folder.mkdir()
    traced = document | {"tracing": _PLAIN | tracing}
    compiled = compile_to(write(traced, folder), folder, 16, 16, part_of(samples))
    return [float(image.y.mean()) for image, _ in run_seeds(compiled, folder, _SEEDS)]


def differ(one: list[float], other: list[float]) -> bool:
    """False alarms: 0.001."""
    return bool(stats.ttest_ind(one, other, equal_var=False).pvalue < 0.001)
