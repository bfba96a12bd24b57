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
    scenes = {sampler: mi.load_file(path, sampler=sampler) for sampler in samplers}
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


def _cpu_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
