"""Runs in Mitsuba's own environment: `mitsuba_server.py VARIANT THREADS SCENE.xml SAMPLER...`; JSON lines ask
and answer.

A request is {"sampler": name, "integrator": name or "", "samples": per pixel, "seed": number,
"image": path}; the image, XYZ, is saved as a NumPy array, and the answer is {"cpu_s": user and system time
of all threads, without loading and saving}.
"""

import json
import os
import resource
import sys
from pathlib import Path
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np


def main() -> None:
    """Answers until the input ends."""
    variant, threads, path, *samplers = sys.argv[1:]
    # What libraries print must not get between the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    mi.set_variant(variant)
    dr.set_thread_count(int(threads))
    scenes = {sampler: _loaded(path, sampler) for sampler in samplers}
    integrators = {}
    for line in sys.stdin:
        request = json.loads(line)
        before = _cpu_s()
        scene = scenes[request["sampler"]]
        other = request["integrator"]
        if other and other not in integrators:
            integrators[other] = mi.load_dict({"type": other})
        integrator = integrators[other] if other else None
        image = mi.render(scene, integrator=integrator, spp=request["samples"], seed=request["seed"])
        pixels = np.array(image)
        cpu_s = _cpu_s() - before
        np.save(request["image"], pixels)
        print(json.dumps({"cpu_s": cpu_s}), file=answers, flush=True)


def _loaded(path: str, sampler: str) -> Any:
    """The scene; one by others has parameters that nothing reads, and a film of colours."""
    mi.file_resolver().append(str(Path(path).parent))
    config = mi.parser.ParserConfig(mi.variant())
    config.unused_parameters = config.unused_properties = mi.LogLevel.Debug
    state = mi.parser.parse_file(config, path, sampler=sampler)
    for node in state.nodes:
        if node.type == mi.ObjectType.Film:
            node.props["pixel_format"] = "xyz"
    mi.parser.transform_all(config, state)
    return mi.parser.instantiate(config, state)


def _cpu_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
