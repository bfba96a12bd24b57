"""What layers, parts of the light and spectral bands cost where they are asked for, and where not.

The Cornell box by nocturne-trace on one thread. Instructions are counted by Valgrind, and only those of
further samples: the difference of two runs has no part of what a run costs by itself. CPU times are taken in
turns. `python -m bench.layers --before PROGRAM` counts those of another build of nocturne-trace, such as one
from before there were parts of the light.
"""

import argparse
import tempfile
from pathlib import Path

from nocturne_client.local.compiled import CompiledFolder
from nocturne_client.local.programs import need_program

from bench.counting import instructions
from bench.programs import trace
from bench.report import Figures, Row, significant, spread, spread_text
from bench.scenes import Document, compile_document, cornell

_FEW, _MANY = 64, 256
_LAYER_SAMPLES = 16
"""What the service makes layers of."""

_ASKED: dict[str, Document] = {
    "nothing": {},
    "parts": {"light_parts": True},
    "ten bands": {"bands": {"first": 380, "last": 780, "width": 40}},
}
"""By name, what the sensor has besides."""


def run(quick: bool) -> Figures:
    """Ratios of instructions and of CPU time to those where nothing is asked for; of layers, how many samples
    of the image cost the same."""
    edge, rounds = (32, 3) if quick else (64, 16)
    program = need_program("nocturne-trace")
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        counted = {name: _of_samples(program, folder, name) for name in _ASKED}
        few = _compiled(folder, "nothing", 16, _FEW)
        looked = _LAYER_SAMPLES, 2 * _LAYER_SAMPLES
        once, twice = (instructions(program, few, ("--layers", samples)) for samples in looked)
        times = _times(folder, edge, rounds)
    nothing = counted.pop("nothing")
    return {
        "instructions": {name: significant(count / nothing) for name, count in counted.items()},
        "time": times,
        "rounds": rounds,
        "layers_cost_samples": significant((twice - once) / (nothing / (_MANY - _FEW))),
    }


def rows(figures: Figures) -> list[Row]:
    """The ratios, and what layers cost."""
    instruction, time = figures["instructions"], figures["time"]
    found = []
    for name, what in (("parts", "with direct and indirect light"), ("ten bands", "with ten bands")):
        found += [
            Row(f"cornell {what} / without: instructions", f"{instruction[name]:.4g}"),
            Row(f"cornell {what} / without: CPU time", spread_text(time[name])),
        ]
    cost = f"{figures['layers_cost_samples']:.3g} of the image's samples"
    return [*found, Row("cornell: all layers, once for a render, cost as much as", cost)]


def _compiled(folder: str, asked: str, edge: int, samples: int) -> CompiledFolder:
    document = cornell()
    document["sensor"] |= _ASKED[asked]
    return compile_document(document, Path(folder) / f"{asked}-{edge}-{samples}", edge, samples, {})


def _of_samples(program: Path, folder: str, asked: str) -> int:
    """Instructions of the samples between few and many."""
    few, many = (_compiled(folder, asked, 16, samples) for samples in (_FEW, _MANY))
    return instructions(program, many) - instructions(program, few)


def _times(folder: str, edge: int, rounds: int) -> Figures:
    compiled = {name: _compiled(folder, name, edge, _FEW) for name in _ASKED}
    ratios: dict[str, list[float]] = {name: [] for name in _ASKED if name != "nothing"}
    for number in range(rounds):
        order = list(compiled) if number % 2 == 0 else list(compiled)[::-1]
        took = {name: trace(compiled[name], 1).tracing_cpu_s for name in order}
        for name in ratios:
            ratios[name].append(took[name] / took["nothing"])
    return {name: spread(each) for name, each in ratios.items()}


def main() -> None:
    """Prints how many instructions a sample of a pixel takes by this build and by another."""
    parser = argparse.ArgumentParser(prog="python -m bench.layers", description=__doc__)
    parser.add_argument("--before", type=Path, required=True, metavar="PROGRAM")
    before = parser.parse_args().before
    pixels = 16 * 16 * (_MANY - _FEW)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        for program in (before, need_program("nocturne-trace")):
            print(f"{program}: {_of_samples(program, folder, 'nothing') / pixels:.1f}")


if __name__ == "__main__":
    main()
