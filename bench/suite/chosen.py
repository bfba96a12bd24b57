"""docs/explanation/chosen.md: how the default traces each scene, and what that is worth; of kept figures."""

from bench.report import Figures
from bench.suite.aims import best
from bench.trap_scenes import TRAPS
from bench.traps import ALONE, DEFAULT

_PAGE = """# What was chosen, and what it was worth

<!-- Made by `make bench`; edit bench/suite/chosen.py, not this page. -->

Nobody has to know how a scene is best traced: a pilot of a few hundred thousand photons tries photons from
the sensor, from the luminaires and from both, and neighbours that share, when the scene is compiled
([decision 0062](../decisions/0062-ways-are-chosen-by-a-pilot.md)), and learns where photons from luminaires
are to be aimed ([decision 0081](../decisions/0081-learned-aims.md)) and photons from the sensor guided
([decision 0104](../decisions/0104-learned-light.md)). Page, EXR (`nocturne:way`) and
`nocturne get` say what it chose. A scene may say otherwise in its `tracing`.

What that is worth on the scenes of [speed.md](speed.md): relMSE of the default at the longest of the equal
times there, over that of photons from the sensor with each pixel alone, and over that of the best way that
we measured, which a person would have to know. What the pilot takes is left out. Of few images: a factor of
1.3 may be chance, and more where single photons decide, as those of the glossy spheres' mirrored Sun. Errors
below 0.01 % (relMSE 1e-8, nearer than references are known) count as equal. *Without the worst*: relMSE x
time over that alone, without the worst 0.1 % of the pixels, at least one.

| scene | chosen | over alone | without the worst | over the best (which) |
| --- | --- | --- | --- | --- |
"""

_FOOLS = """
## Scenes made to fool it

Light through a keyhole, behind panes, by mirrors, from one lamp of many and the like (`python -m bench
traps`): efficiency, 1 / (relMSE x processor time), of the default over that alone, and over that of the
best of adjoint, shared, both directions, and both and shared.

| scene | chosen | over alone | over the best (which) |
| --- | --- | --- | --- |
"""


_EXACT = 1e-8


def chosen(figures: Figures, latest: Figures) -> str:
    """The page, from the suite's figures and those of all benches."""
    lines = [_PAGE.rstrip()]
    for name, scene in figures.items():
        ways = scene["ways"]
        found = best(ways, peers=False)
        default, alone = ways["auto"]["error"], ways["two photons"]["error"]
        over_best = "" if found is None else f"{_over(default, ways[found]['error']):.2g} ({found})"
        calm = _calm(ways["auto"]) / _calm(ways["two photons"])
        over_alone = f"{_over(default, alone):.2g} | {calm:.2g}"
        lines.append(f"| {name} | {_short(scene['chosen'])} | {over_alone} | {over_best} |")
    if "traps" in latest:
        lines.append(_FOOLS.rstrip())
        for name in TRAPS:
            found = latest["traps"][name]
            ways = found["ways"]
            first = max(ways, key=ways.__getitem__)
            lines.append(
                f"| {name} | {_short(found['chosen'])} | {ways[DEFAULT] / ways[ALONE]:.3g} "
                f"| {ways[DEFAULT] / ways[first]:.2g} ({first}) |"
            )
    return "\n".join(lines) + "\n"


def _over(ours: float, theirs: float) -> float:
    return max(ours, _EXACT) / max(theirs, _EXACT)


def _calm(way: Figures) -> float:
    last: Figures = way["points"][-1]
    return float(last["trimmed"] * last["cpu_s"])


def _short(told: str) -> str:
    """Without the pilot's own figures, which are of fewer photons."""
    return told.partition(":")[0]
