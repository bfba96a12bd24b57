"""Runs in Mitsuba's own environment: `mitsuba_batches.py VARIANT SCENE.xml SAMPLES BATCHES IMAGES.npy`.

Saves XYZ images of independent seeds, shape (batches, height, width, 3).
"""

import sys

import drjit as dr
import mitsuba as mi
import numpy as np


def main() -> None:
    """Renders."""
    variant, scene, samples, batches, images = sys.argv[1:]
    mi.set_variant(variant)
    dr.set_thread_count(2)
    loaded = mi.load_file(scene, spp=samples)
    frames = [np.array(mi.render(loaded, spp=int(samples), seed=seed)) for seed in range(int(batches))]
    np.save(images, np.stack(frames))


if __name__ == "__main__":
    main()
