"""Runs in Mitsuba's own environment: `mitsuba_stokes.py SCENE.xml SAMPLES FRAMES OUT.npy`. Saves frames with
independent noise, shape (frames, height, width, 4): luminances of S0 to S3 in Mitsuba's unit."""

import sys
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np

_LUMINANCE = np.array([0.212671, 0.715160, 0.072169])
"""Of linear sRGB (IEC 61966-2-1), which channels of its Stokes vectors are in."""


def main() -> None:
    """Renders them."""
    scene, samples, frames, out = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    mi.set_variant("llvm_ad_spectral_polarized")
    mi.file_resolver().append(str(scene.parent))
    loaded: Any = mi.load_file(str(scene))
    integrator = mi.load_dict({"type": "stokes", "nested": {"type": "path", "max_depth": -1}})
    found = []
    for seed in range(1, frames + 1):
        image = np.array(mi.render(loaded, integrator=integrator, spp=samples, seed=seed))
        # The film's own channels come first.
        found.append(image[..., -12:].reshape(*image.shape[:2], 4, 3) @ _LUMINANCE)
    np.save(out, np.stack(found))


if __name__ == "__main__":
    main()
