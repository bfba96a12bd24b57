"""Runs in Mitsuba's own environment: `mitsuba_server.py VARIANT THREADS SCENE`; JSON lines ask and answer.

SCENE is a JSON file; of its sensors only the samplers differ. A request is
{"sensor": index, "samples": per pixel, "seed": number, "image": path}; the image, XYZ, is saved as a NumPy
array, and the answer is {"cpu_s": user and system time of all our threads, without loading and saving}.
"""

import json
import os
import resource
import sys
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np


def main() -> None:
    """Answers until the input ends."""
    variant, threads, path = sys.argv[1:]
    # What libraries print must not get between the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    mi.set_variant(variant)
    dr.set_thread_count(int(threads))
    with open(path) as file:  # noqa: PTH123
        scene = mi.load_dict(_with_transforms(json.load(file)))
    for line in sys.stdin:
        request = json.loads(line)
        before = _cpu_s()
        image = mi.render(
            scene, sensor=scene.sensors()[request["sensor"]], spp=request["samples"], seed=request["seed"]
        )
        pixels = np.array(image)
        cpu_s = _cpu_s() - before
        np.save(request["image"], pixels)
        print(json.dumps({"cpu_s": cpu_s}), file=answers, flush=True)


def _with_transforms(description: Any) -> Any:
    if not isinstance(description, dict):
        return description
    return {
        key: mi.ScalarTransform4f(value) if key == "to_world" else _with_transforms(value)
        for key, value in description.items()
    }


def _cpu_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
