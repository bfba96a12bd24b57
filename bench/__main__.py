"""`python -m bench [NAME...] [--quick]`: one JSON line for each bench, kept in results/."""

import argparse
import json
import sys

from nocturne_client.errors import NocturneClientError

from bench import (
    accumulation,
    annual_coverage,
    choices,
    crowds,
    dispersion,
    duplicates,
    error_bars,
    first_tile,
    full_films,
    grid,
    heavy_tail,
    layers,
    media,
    meters,
    mixture,
    page,
    peers,
    pilot_choices,
    pilot_cost,
    pilot_sharing,
    plain,
    radiance,
    rare_light,
    real,
    sampling,
    scale,
    service,
    sharing,
    small_renders,
    stops,
    traps,
    traversal,
    visible_sky,
    watchers,
)
from bench.machine import load_average
from bench.report import Bench, Figures, Skipped, keep

BENCHES: dict[str, Bench] = {
    "traversal": traversal,
    "annual_coverage": annual_coverage,
    "service": service,
    "first_tile": first_tile,
    "sharing": sharing,
    "pilot_sharing": pilot_sharing,
    "small_renders": small_renders,
    "traps": traps,
    "full_films": full_films,
    "scale": scale,
    "duplicates": duplicates,
    "mixture": mixture,
    "rare_light": rare_light,
    "sampling": sampling,
    "choices": choices,
    "dispersion": dispersion,
    "media": media,
    "meters": meters,
    "grid": grid,
    "peers": peers,
    "radiance": radiance,
    "real": real,
    "visible_sky": visible_sky,
    "watchers": watchers,
    "page": page,
    "crowds": crowds,
    "error_bars": error_bars,
    "heavy_tail": heavy_tail,
    "stops": stops,
    "accumulation": accumulation,
    "pilot_choices": pilot_choices,
    "pilot_cost": pilot_cost,
    "plain": plain,
    "layers": layers,
}


def main() -> int:
    """Runs the benches asked for; the exit code is 1 where one failed, 0 where one was skipped."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"one of {', '.join(BENCHES)}; all by default"
    )
    parser.add_argument("--quick", action="store_true", help="small renders, to see that it works; not kept")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.names) - set(BENCHES))
    if unknown:
        parser.error(f"no bench {', '.join(unknown)}; expected one of {', '.join(BENCHES)}")
    try:
        for name in arguments.names or BENCHES:
            try:
                figures = _run(BENCHES[name], arguments.quick)
            except Skipped as reason:
                print(f"bench: {name} is skipped: {reason}", file=sys.stderr)
                continue
            print(json.dumps({"bench": name, **figures}), flush=True)
            if not arguments.quick:
                keep(name, figures, BENCHES)
    except NocturneClientError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    return 0


def _run(bench: Bench, quick: bool) -> Figures:
    """The figures with the load average before and after: other programs' work, and our own."""
    before = load_average()
    figures = bench.run(quick)
    return {**figures, "load_average": [before, load_average()]}


if __name__ == "__main__":
    sys.exit(main())
