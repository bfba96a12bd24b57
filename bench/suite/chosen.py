"""docs/explanation/chosen.md: the default's method for each scene, and its gain; from kept figures."""

from bench.report import Figures
from bench.suite.aims import best
from bench.trap_scenes import TRAPS
from bench.traps import ALONE, DEFAULT

_PAGE = """# The chosen methods, and their gains

<!-- Made by `make bench`; edit bench/suite/chosen.py, not this page. -->

Users need not know the best method for a scene. When the scene is compiled, a pilot of a few hundred
thousand photons tries photons from the sensor, from the luminaires and from both, and sharing between
neighbours ([decision 0062](../decisions/0062-ways-are-chosen-by-a-pilot.md)). It also learns targets for
photons from luminaires and directions for photons from the sensor ([method](method.md)). Page, EXR
(`nocturne:way`) and `nocturne get` show its choice. A scene may choose otherwise in its `tracing`.

The table has ratios of relMSE at equal time on the scenes of [speed.md](speed.md), at the longest of the
times there. Below 1 the default is better.

- *Over alone* compares the default with photons from the sensor, each pixel alone.
- *Over the best* compares it with the best method that was measured for that scene.
- *Without the worst* is like *over alone*, but for relMSE x time without the worst 0.1 % of the pixels, at
  least one.

The pilot's own time is not included. Few images were measured: a factor of 1.3 may be chance, and more where
single photons decide, as those of the glossy spheres' mirrored Sun. Errors below 0.01 % (relMSE 1e-8, smaller
than those of the references) count as equal.

| scene | chosen | over alone | without the worst | over the best (which) |
| --- | --- | --- | --- | --- |
"""

_FOOLS = """
## Scenes made to fool it

These scenes have light through a keyhole, behind panes, by mirrors, from one lamp of many and the like
(`python -m bench traps`). The table has ratios of efficiency, 1 / (relMSE x processor time): of the default
over photons from the sensor with each pixel alone, and over the best of adjoint, shared, both directions,
and both and shared. Above 1 the default is better.

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
