"""A pilot's part of a render of a minute, for scenes that gain by it and for those that do not.

The figure is the processor seconds of compiling a scene that leaves the method open, less those of the same
scene with a named method, over a minute. The suite's scenes have a larger film here, as sharing needs one.
"""

import tempfile
from pathlib import Path

from bench.peer.contenders import FilmSize, Ours
from bench.programs import children_cpu_s
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film
from bench.suite.references import THREADS, samples_for
from bench.suite.scenes import SCENES, SuiteScene, Tracing

_FILM, _QUICK_FILM = FilmSize(256, 192), FilmSize(48, 36)
_RENDER_CPU_S, _QUICK_RENDER_CPU_S = 60.0, 1.0
_TRIAL_CPU_S = 1.0
_NAMED: Tracing = {"direction": "adjoint", "sharing": 1}
_OPEN: Tracing = {"direction": "auto", "sharing": "auto"}


def run(quick: bool) -> Figures:
    """One render of each scene; nothing is traced but trials and pilots."""
    film = _QUICK_FILM if quick else _FILM
    cpu_s = _QUICK_RENDER_CPU_S if quick else _RENDER_CPU_S
    return {name: _scene(scene, film, cpu_s) for name, scene in SCENES.items()}


def rows(figures: Figures) -> list[Row]:
    """Those that gain nothing have an aim."""
    table = []
    for name in SCENES:
        found = figures[name]
        gains = "shared" in found["chosen"] or "luminaires" in found["chosen"] or "both" in found["chosen"]
        what = f"{name}: pilot's processor time, of a render of a minute; {found['chosen'].partition(':')[0]}"
        table.append(Row(what, f"{100 * found['part']:.2g} %", "" if gains else "at most 3 %"))
    return table


def _scene(scene: SuiteScene, film: FilmSize, cpu_s: float) -> Figures:
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        document = scene.document(place)
        named = compile_film(_traced(document, _NAMED), place, film.width, film.height, 1, place / "trial")
        ours = Ours(named, film, THREADS, ())
        trial_s = min(_TRIAL_CPU_S, cpu_s)
        samples = max(1, round(samples_for(ours, trial_s) * cpu_s / trial_s))
        taken: list[float] = []
        chosen = ""
        for tracing in (_NAMED, _OPEN):
            began = children_cpu_s()
            compiled = compile_film(
                _traced(document, tracing), place, film.width, film.height, samples, place / str(len(taken))
            )
            taken.append(children_cpu_s() - began)
            chosen = compiled.way
        return {
            "samples": samples,
            "pilot_cpu_s": significant(taken[1] - taken[0]),
            "part": significant((taken[1] - taken[0]) / cpu_s),
            "chosen": chosen,
        }


def _traced(document: Document, tracing: Tracing) -> Document:
    return {**document, "tracing": {**document.get("tracing", {}), **tracing}}
