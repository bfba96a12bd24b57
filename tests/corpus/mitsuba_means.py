"""Runs in Mitsuba's own environment.

`mitsuba_means.py VARIANT SCENE.xml WIDTH HEIGHT SAMPLES BATCHES MEANS.npy`

Renders a scene on a separate film, with a box filter and independent numbers, and saves the mean X, Y, Z of
each batch's image, shape (batches, 3).
"""

import sys
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np

# What cuts a part out of the film, or looks over its edge.
_LEFT_OUT = ("crop_width", "crop_height", "crop_offset_x", "crop_offset_y", "sample_border")


def loaded(file: str, width: int, height: int) -> Any:
    """The scene with another film."""
    mi.file_resolver().append(str(Path(file).parent))
    config = mi.parser.ParserConfig(mi.variant())
    # As mi.load_file has it: scenes may have parameters that nothing reads.
    config.unused_parameters = mi.LogLevel.Debug
    # Scenes of the documentation leave the number of samples to whoever renders them.
    state = mi.parser.parse_file(config, file, spp="16")
    for node in state.nodes:
        properties = node.props
        if node.type == mi.ObjectType.Film:
            for name in _LEFT_OUT:
                if name in properties:
                    del properties[name]
            properties.set_plugin_name("hdrfilm")
            properties["width"], properties["height"] = width, height
            properties["pixel_format"] = "xyz"
        if node.type == mi.ObjectType.ReconstructionFilter:
            _replace(properties, "box")
        if node.type == mi.ObjectType.Sampler:
            _replace(properties, "independent")
    mi.parser.transform_all(config, state)
    return mi.parser.instantiate(config, state)


def _replace(properties: Any, plugin: str) -> None:
    for name in list(properties.keys()):
        del properties[name]
    properties.set_plugin_name(plugin)


def main() -> None:
    """Renders."""
    variant, file, width, height, samples, batches, means = sys.argv[1:]
    mi.set_variant(variant)
    scene = loaded(file, int(width), int(height))
    found = []
    for seed in range(int(batches)):
        image = np.array(mi.render(scene, spp=int(samples), seed=seed), dtype=np.float64)
        found.append(image[..., :3].mean(axis=(0, 1)))
    np.save(means, np.stack(found))


if __name__ == "__main__":
    main()
