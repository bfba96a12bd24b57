"""Runs in Mitsuba's own environment: `mitsuba_server.py VARIANT THREADS SCENE.xml SAMPLER...`; JSON lines ask
and answer. With `--film WIDTH HEIGHT` it renders on another film, with a box filter and independent numbers;
with `--strict` it refuses properties that nothing reads, as Mitsuba does.

A request is {"sampler": name, "integrator": name or "", "samples": per pixel, "seed": number,
"image": path}; the image, XYZ, is saved as a NumPy array, and the answer is {"cpu_s": user and system time
of all threads, without loading and saving}.
"""

import argparse
import json
import os
import resource
import sys
from pathlib import Path
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

# What cuts a part out of a film, or looks over its edge.
_LEFT_OUT = ("crop_width", "crop_height", "crop_offset_x", "crop_offset_y", "sample_border")


def main() -> None:
    """Answers until the input ends."""
    parser = argparse.ArgumentParser()
    parser.add_argument("variant")
    parser.add_argument("threads", type=int)
    parser.add_argument("scene", type=Path)
    parser.add_argument("samplers", nargs="+")
    parser.add_argument("--film", nargs=2, type=int)
    parser.add_argument("--strict", action="store_true")
    options = parser.parse_args()
    # What libraries print must not get between the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    mi.set_variant(options.variant)
    dr.set_thread_count(options.threads)
    scenes = {
        sampler: _loaded(options.scene, sampler, options.film, options.strict) for sampler in options.samplers
    }
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


def _loaded(path: Path, sampler: str, film: list[int] | None, strict: bool) -> Any:
    """The scene, with a film of colours."""
    mi.file_resolver().append(str(path.parent))
    config = mi.parser.ParserConfig(mi.variant())
    config.unused_parameters = mi.LogLevel.Debug
    if not strict:
        config.unused_properties = mi.LogLevel.Debug
    # Scenes of the documentation leave the number of samples to whoever renders them.
    state = mi.parser.parse_file(config, str(path), sampler=sampler, spp="16")
    for node in state.nodes:
        if node.type == mi.ObjectType.Film:
            node.props["pixel_format"] = "xyz"
            if film:
                _resize(node.props, *film)
        if film and node.type == mi.ObjectType.ReconstructionFilter:
            _replace(node.props, "box")
        if film and node.type == mi.ObjectType.Sampler:
            _replace(node.props, "independent")
    mi.parser.transform_all(config, state)
    return mi.parser.instantiate(config, state)


def _resize(film: Any, width: int, height: int) -> None:
    for name in _LEFT_OUT:
        if name in film:
            del film[name]
    film.set_plugin_name("hdrfilm")
    film["width"], film["height"] = width, height


def _replace(properties: Any, plugin: str) -> None:
    for name in list(properties.keys()):
        del properties[name]
    properties.set_plugin_name(plugin)


def _cpu_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
