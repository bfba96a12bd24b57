"""Which parts of the examples matter for an error of 2 %: `nocturne preflight` over all of them.

Keeps the results as JSON and as a table in bench/results.

`python -m bench.preflights [--budget SECONDS] [SCENE ...]`: a scene is a folder of examples; by default, all
are.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from nocturne_client.local.programs import CHECKOUT
from nocturne_scene.simplify.simplification import assets_of

from bench.programs import run

SCENES = CHECKOUT / "examples"
RESULTS = CHECKOUT / "bench" / "results" / "preflights.json"
TABLE = RESULTS.with_suffix(".md")

_TARGET = "2%"

Found = dict[str, Any]


def main() -> None:
    """Run preflights, keep the results and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--budget", type=float, default=120.0)
    parser.add_argument("scenes", nargs="*")
    arguments = parser.parse_args()
    known = sorted(file.parent.name for file in SCENES.glob("*/scene.json"))
    preflights: dict[str, Found] = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    for name in arguments.scenes or known:
        print(name, flush=True)
        _make_files(SCENES / name)
        preflights[name] = _preflight(SCENES / name / "scene.json", arguments.budget)
        RESULTS.write_text(json.dumps(preflights, indent=1, sort_keys=True) + "\n")
    TABLE.write_text("# What the examples need for 2 %\n\n" + _table(preflights))


def _make_files(folder: Path) -> None:
    """The files that a scene's own program makes, where any is missing."""
    text = (folder / "scene.json").read_text()
    if all((folder / asset).exists() for asset in assets_of(json.loads(text))):
        return
    for program in folder.glob("make_*.py"):
        run([sys.executable, program])


def _preflight(scene: Path, budget: float) -> Found:
    command = [sys.executable, "-m", "nocturne_client", "preflight", str(scene), "--error", _TARGET]
    command += ["--budget", str(budget), "--json"]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    found: Found = json.loads(done.stdout)
    found["scene"] = scene.parent.name
    return found


def _table(preflights: dict[str, Found]) -> str:
    lines = [
        "| scene | needed | not needed, or another way to the same image | not decided | enough | saves |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, found in sorted(preflights.items()):
        words = {
            verdict: _words(found, verdict) for verdict in ("needed", "not needed", "undecided", "same image")
        }
        harmless = "; ".join(filter(None, (words["not needed"], words["same image"])))
        lines.append(f"| {name} | {words['needed']} | {harmless} | {words['undecided']} | {_end(found)} |")
    return "\n".join([*lines, ""])


def _words(found: Found, verdict: str) -> str:
    """Simplifications with both biases; those that do no harm with the time to 2 %."""
    words = []
    for model in found["models"]:
        if model["verdict"] == verdict:
            mean, local = model["mean_bias"]["value"], model["local_bias"]["value"]
            size = f"mean {mean:+.1%}, local {local:.1%}"
            if verdict in ("not needed", "same image"):
                # Times are rounded to what a pilot knows of them.
                size = f"{model['cpu_seconds'] / found['full']['cpu_seconds']:.2g} of the time"
            words.append(f"{', '.join(model['without'])} ({size})")
    return "; ".join(words)


def _end(found: Found) -> str:
    if found["pilot"]["heavy_tails"]:
        return "rare photons carry the noise: nothing is chosen | ?"
    chosen = "; ".join(found["chosen"]["without"]) or "nothing less"
    blurred = " (the pilot was too short for 1 %)" if found["pilot"]["recommended_cpu_seconds"] else ""
    return f"{chosen}{blurred} | {found['saving']:.1f} times"


if __name__ == "__main__":
    main()
