"""Random scenes, as far as they can be exported, by Mitsuba 3 and by ours: ten minutes; `make peers`.

False alarms: 1 % for all together. Seeds are fixed. Mitsuba's images state no errors, so that where light is
met seldom the scatter of seeds is too small: scenes with small lamps are left to our own methods, and what
looks wrong is traced again with sixteen times the samples.
"""

from pathlib import Path

import pytest
from nocturne_scene.film import Film

from tests.crossings import assets, mitsuba
from tests.crossings.judging import ALPHA, Difference, differences, holm
from tests.crossings.methods import PLAIN, methods_of, traced
from tests.crossings.scenes import Scene, scene

pytestmark = [
    pytest.mark.peers,
    pytest.mark.skipif(not mitsuba.PYTHON.exists(), reason="needs Mitsuba in build/peers: `make peers`"),
]

_SCENES, _SAMPLES, _SEEDS, _MORE = 100, 64, 8, 16


def _look(made: Scene, folder: Path) -> Difference | None:
    """The difference by new samples; None where there is nothing to compare, or none is to be seen."""
    part = mitsuba.exportable(made.document, folder, Film(made.width, made.height, _SAMPLES))
    if part is None:
        return None
    plain = part | {"tracing": methods_of(made)[PLAIN]["tracing"] | part.get("tracing", {})}
    found = None
    for samples in (_SAMPLES, _MORE * _SAMPLES):
        ours = traced(plain, made, folder, samples, _SEEDS)
        (found,) = differences({"ours": ours, "Mitsuba": mitsuba.traced(part, made, folder, samples, _SEEDS)})
        if found.probability >= ALPHA:
            return None
    return found


def test_mitsuba_agrees(tmp_path: Path) -> None:
    assets.write(tmp_path)
    scenes = [each for each in map(scene, range(_SCENES)) if each.wide]
    found = [(each.seed, _look(each, tmp_path)) for each in scenes]
    wrong = holm([1.0 if each is None else each.probability for _, each in found])
    told = [f"seed {seed}: {each}" for (seed, each), is_wrong in zip(found, wrong, strict=True) if is_wrong]
    assert not told, "\n".join(told)
