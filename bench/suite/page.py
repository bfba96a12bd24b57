"""speed.md, accuracy.md and chosen.md, the suite's README, and charts, written from kept figures."""

import json

from nocturne_client.local.chart import Line, write_chart
from nocturne_client.local.programs import CHECKOUT

from bench import accumulation, error_bars
from bench.coverage_chart import coverage_chart
from bench.errors import expected_relmse
from bench.report import Figures, Row, kept, results_folder
from bench.suite.aims import AIMS, WHY, best
from bench.suite.chosen import chosen
from bench.suite.measure import MITSUBA, NOT_FALLING, TARGET
from bench.suite.references import load
from bench.suite.scenes import SCENES

SUMMARY = "speed-summary.json"
COVERAGE = "coverage.svg"

_SPEED = """# Speed: error against time

<!-- Made by `make bench`; edit bench/suite/page.py, not this page. -->

How long does an image take that is right to 1 % (relMSE of Y {target:g}), and how long with Mitsuba 3? Errors
are against [stored references](accuracy.md). Times are CPU times of one processor, without loading and
compiling, measured in one run, in turns. relMSE = mean of (I - R)^2 / (R^2 + 0.01 mean(R)^2).

Films have only some 24 by 16 pixels, so that references are small: this compares methods, not pictures of
a million pixels. Mitsuba's llvm variants have a fixed cost for each image, which matters less on larger
films.

Every method with its error, exponent and bias: [the suite](../../bench/suite/README.md). What the default
chooses: [chosen methods](chosen.md). `make bench` measures it again.

"""

_DETAILS = """# The suite: error against time, method by method

<!-- Made by `make bench`; edit bench/suite/page.py, not this page. -->

Seconds of one processor that each method needs for relMSE {target:g} of Y, and their ratio to the best
([summary](../../docs/explanation/speed.md)).

- *Exponent*: the error falls with this power of time. Independent samples give -1, and Sobol points are
  steeper on smooth scenes. Above {falling:g} a method does not converge within these times, and no time to
  1 % is shown. Times below the shortest that was measured count as equal.
- *relMSE*: at the longest time, by a line fitted through all times.
- *Without the worst*: relMSE at the longest time without the worst 0.1 % of the pixels, at least one, over
  that of all pixels. Far below 1, single pixels carry the error.
- *z*: deviation of the image's mean in standard errors, at the longest time. A method that finds no light
  has a relMSE below 1 and a large z.

The methods are those of the [torture cases](../../docs/explanation/stability.md).

    make bench                            # all benches, and this; the suite alone: a quarter of an hour
    make bench BENCH=full                 # longer times, three rounds: hours
    python -m bench.suite cornell smoke   # some scenes; the others' figures stay
    python -m bench.suite --pages         # these pages and charts from kept figures
"""

_ACCURACY = """# Accuracy: references and errors

<!-- Made by `make bench`; edit bench/suite/page.py, not this page. -->

How far to trust a pixel: [units and errors](units-and-errors.md). All simplifications:
[limits](../limits.md). Scenes that break methods: [stability](stability.md). Commands: `make bench`, `make
stability`; references: `python -m bench.suite --references`.

## References

A reference is the mean of 16 independent images by the most reliable method for its scene, with its own
error, checked by a second method.

- *relMSE*: the reference's own error. It is subtracted, in expectation, from errors measured against the
  reference; a method no worse than this cannot be ranked.
- *Ratio*: mean luminance over that of the second method, which should be 1.
- *rms z*: differences of pixels over their standard errors, a little above 1 if both are right (errors from
  16 images are themselves uncertain). A large rms z with a ratio near 1 is due to rare bright photons in the
  second method.

The second method seldom finds the light of the headlight: few bright photons make its mean, and its own error
is too small. With 170 CPU s in eight images it was 3.83 +- 0.27 cd/m2, and the first method 3.697 +- 0.008.

| scene | CPU s | error of a pixel, median | relMSE | ratio of means | z | rms z |
| --- | --- | --- | --- | --- | --- | --- |
"""


def write_pages(figures: Figures) -> None:
    """All pages, and a chart for each scene."""
    docs = CHECKOUT / "docs" / "explanation"
    (docs / "speed.md").write_text(speed(figures))
    (CHECKOUT / "bench" / "suite" / "README.md").write_text(details(figures))
    (docs / "accuracy.md").write_text(accuracy(references()))
    (docs / "chosen.md").write_text(chosen(figures, kept()))
    if "error_bars" in kept():
        (results_folder() / COVERAGE).write_text(coverage_chart(kept()["error_bars"]))
    for name, found in figures.items():
        _chart(name, found["ways"])
    summary = results_folder() / SUMMARY
    summary.write_text(json.dumps(summary_of(figures), indent=1) + "\n")


def summary_of(figures: Figures) -> list[dict[str, object]]:
    """Data of the page's two charts, by scene: seconds to 1 % by each of our methods, including the default,
    and the default's error over that of the peer's best in the same time. None: not known."""
    found = []
    for name, scene in figures.items():
        ways = scene["ways"]
        default = ways.get("auto", ways.get("two photons", {}))
        theirs = best(ways, peers=True)
        ours = [
            way["seconds_to_1_percent"]
            for way_name, way in ways.items()
            if not way_name.startswith(MITSUBA) and "seconds_to_1_percent" in way
        ]
        ratio = default["error"] / ways[theirs]["error"] if theirs and "error" in default else None
        seconds = default.get("seconds_to_1_percent")
        found.append({"scene": name, "default": seconds, "ways": sorted(ours), "beside_peer": ratio})
    return found


def speed(figures: Figures) -> str:
    """Times of the default, of the best method and of Mitsuba, and the aims."""
    lines = [
        _SPEED.format(target=TARGET),
        "## CPU seconds to 1 %",
        "",
        "| scene | default | best of Nocturne's methods | best of Mitsuba's variants |",
        "| --- | --- | --- | --- |",
    ]
    for name, found in figures.items():
        shortest = min(found["budgets_cpu_s"])
        ways = found["ways"]
        ours = [way for way in ways if not way.startswith(MITSUBA)]
        theirs = [way for way in ways if way.startswith(MITSUBA)]
        default = _fastest(ways, ["auto" if "auto" in ways else "two photons"], shortest)
        found_by = f"{_fastest(ways, ours, shortest)} | {_fastest(ways, theirs, shortest)}"
        lines.append(f"| {name} | {default} | {found_by} |")
    alone = [name for name in AIMS if name in figures and _alone(figures[name]["ways"])]
    notes = [f"- **{name}**: {WHY[name]}" for name in alone]
    chance = "Few images were measured: a factor of 1.3 may be chance, and more where single photons decide."
    aims = "Errors at equal time over those of Mitsuba, and aims: [the suite](../../bench/suite/README.md)."
    return "\n".join([*lines, "", chance, "", *notes, "", aims]) + "\n"


def _alone(ways: Figures) -> bool:
    """Whether there is nothing to compare with."""
    return best(ways, peers=True) is None or best(ways, peers=False) is None


def _fastest(ways: Figures, names: list[str], shortest: float) -> str:
    """The least time of some methods, and which has it."""
    times = {
        each: ways[each]["seconds_to_1_percent"] for each in names if "seconds_to_1_percent" in ways[each]
    }
    if not times:
        return "does not converge" if names else "can't render it"
    best_one = min(times, key=lambda each: times[each])
    told = f"less than {shortest:g}" if times[best_one] <= shortest else f"{times[best_one]:.3g}"
    return told if len(names) == 1 else f"{told} ({best_one.removeprefix('Mitsuba ')})"


def details(figures: Figures) -> str:
    """A table of times for each scene."""
    lines = [_DETAILS.format(target=TARGET, falling=NOT_FALLING), *_aims(figures)]
    for name, found in figures.items():
        lines += [f"\n## {name.capitalize()}\n", f"![{name}](../results/{_file(name)})\n"]
        lines += [
            "| method | CPU s to 1 % | over the best | exponent | relMSE | without the worst | z |",
            "| --- | --- | --- | --- | --- | --- | --- |",
        ]
        lines += _rows(found["ways"], min(found["budgets_cpu_s"]))
        lines += [f"\nauto: {found['chosen']}."] if found.get("chosen") else []
        lines += [f"\n{who} is not there: {why}." for who, why in found["not there"].items()]
        budgets = ", ".join(f"{budget:g}" for budget in found["budgets_cpu_s"])
        rounds = "once" if found["rounds"] == 1 else f"medians of {found['rounds']} rounds"
        load = " to ".join(f"{each:g}" for each in found["load_average"])
        lines += [f"\n{budgets} CPU s, {rounds}. {found['machine']}, load average {load}."]
    return "\n".join(lines) + "\n"


def _aims(figures: Figures) -> list[str]:
    """Error at equal CPU time over the peer's best, and the aim."""
    lines = [
        "## Compared with Mitsuba 3",
        "",
        "relMSE at the longest time over that of the best variant of Mitsuba, by export: Nocturne's best",
        "method, its default, and the aim. Few images were measured: a factor of 1.3 may be chance, and more",
        "where single photons decide. Baselines do not count as Nocturne's. *Reference*: the reference's own",
        "relMSE over that of the peer. Near 1 the peer may be better than the figure, above 1 no comparison",
        "is possible.",
        "",
        "| scene | our best | default | reference | aim | |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    why = []
    for name, aim in AIMS.items():
        ways = figures.get(name, {}).get("ways", {})
        theirs, ours = best(ways, peers=True), best(ways, peers=False)
        if theirs is None or ours is None:
            told = "not comparable" if name in figures else "not measured"
            lines.append(f"| {name} | | | | at most {aim:g} | {told} |")
            continue
        ratio = ways[ours]["error"] / ways[theirs]["error"]
        default = ways.get("auto", ways["two photons"])["error"] / ways[theirs]["error"]
        stored = load(name).reference
        own = expected_relmse(stored.error, stored.y) / ways[theirs]["error"]
        told = "held"
        if own > 1.0:
            told = "not comparable: the peer's error is below the reference's own"
        elif ratio > aim:
            told = f"**missed by {ratio / aim:.2g}**"
            why.append(f"- **{name}**: {WHY[name]}")
        ratios = f"{ratio:.2g} ({ours}) | {default:.2g} | {own:.1g}"
        lines.append(f"| {name} | {ratios} | at most {aim:g} | {told} |")
    return [*lines, "", *why]


def accuracy(found: Figures) -> str:
    """References, error bars, accumulation."""
    lines = [_ACCURACY.rstrip()]
    for name, told in found.items():
        agree = told["agreement"]
        z = (agree["ratio"] - 1.0) / agree["ratio_error"] if agree["ratio_error"] else 0.0
        lines.append(
            f"| {name} | {told['cpu_s']:g} | {100 * told['error']:.2g} % | {told['relmse']:.2g} "
            f"| {agree['ratio']:.5f} | {z:.1f} | {agree['rms_z']:.3g} |"
        )
    latest = kept()
    if "error_bars" in latest:
        lines += ["", "## Error bars", "", str(error_bars.__doc__).strip(), ""]
        lines += error_bars.table(latest["error_bars"])
    if "accumulation" in latest:
        lines += ["", "## Accumulation", "", str(accumulation.__doc__).strip(), ""]
        lines += _table(accumulation.rows(latest["accumulation"]))
        lines += ["", f"Chart: [accumulation](../../bench/results/{accumulation.CHART})"]
    return "\n".join(lines) + "\n"


def references() -> Figures:
    """Costs and errors of the stored references, by scene."""
    found: Figures = {}
    for name in SCENES:
        stored = load(name)
        lit = stored.reference.y > 0.0
        relative = sorted((stored.reference.error[lit] / stored.reference.y[lit]).tolist())
        found[name] = {
            "cpu_s": stored.cpu_s,
            "error": relative[len(relative) // 2],
            "relmse": expected_relmse(stored.reference.error, stored.reference.y),
            "agreement": stored.agreement,
        }
    return found


def _rows(ways: Figures, shortest: float) -> list[str]:
    """Times below the shortest that was measured are shown as such, and count as equal."""
    times = [
        max(way["seconds_to_1_percent"], shortest) for way in ways.values() if "seconds_to_1_percent" in way
    ]
    lines = []
    for name, way in ways.items():
        if "error" not in way:
            lines.append(f"| {name} | too slow, or no error to be seen | | | | | |")
            continue
        last = way["points"][-1]
        seconds = way.get("seconds_to_1_percent")
        time = "does not converge |"
        if seconds is not None:
            told = f"{seconds:.3g}" if seconds > shortest else f"less than {shortest:g}"
            time = f"{told} | {max(seconds, shortest) / min(times):.3g}"
        trimmed = last["trimmed"] / last["relmse"] if last["relmse"] > 0.0 else 1.0
        lost = f"; {100 * last['not_finite']:.2g} % of the pixels not finite" if last["not_finite"] else ""
        errors = f"{way['exponent']:g} | {way['error']:.2g} | {trimmed:.2g} | {last['z']:.1f}{lost}"
        lines.append(f"| {name} | {time} | {errors} |")
    return lines


def _table(rows: list[Row]) -> list[str]:
    return [
        "| what | figure | aim |",
        "| --- | --- | --- |",
        *(f"| {row.what} | {row.figure} | {row.aim} |" for row in rows),
    ]


def _chart(name: str, ways: Figures) -> None:
    lines = []
    for way, found in ways.items():
        points = [
            (p["cpu_s"], p["relmse"]) for p in found["points"] if p["relmse"] > 0.0 and p["cpu_s"] > 0.0
        ]
        if points:
            lines.append(Line(way, sorted(points)))
    if lines:
        write_chart(
            results_folder() / _file(name), f"{name}: relMSE over CPU seconds", "CPU s", "relMSE", lines
        )


def _file(name: str) -> str:
    return f"suite-{name.replace(' ', '-')}.svg"
