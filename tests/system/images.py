"""EXRs in memory, compared bit by bit."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
import numpy.typing as npt

from tests.coordinator.service import read_channel, read_exr, read_further_responses, read_rgb

Channel = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Image:
    """One rendered image."""

    xyz: Channel
    """Shape (height, width, 3), Y in cd/m2."""
    y_stderr: Channel
    """Standard error of Y as the image tells it, shape (height, width)."""
    y_error: Channel
    """The same by each pixel's own samples: what many pixels' statistics are made of."""
    samples: npt.NDArray[np.uint32]
    """Per pixel, shape (height, width)."""
    further: Mapping[str, Channel]
    """The sensor's further responses by name, shape (height, width) each."""
    rgb: Channel
    """What viewers show, shape (height, width, 3); empty where a response has one of the names."""

    @classmethod
    def read(cls, path: Path) -> Self:
        xyz, told, samples = read_exr(path)
        error = told * np.sqrt(read_channel(path, "Y.ownRatio"))
        return cls(xyz, told, error, samples, read_further_responses(path), read_rgb(path))

    @property
    def y(self) -> npt.NDArray[np.float64]:
        return self.xyz[..., 1].astype(np.float64)


def differing_values(one: Image, other: Image) -> dict[str, int]:
    """How many values of each channel differ in any bit; empty where the images are the same."""
    pairs = {
        "XYZ": (one.xyz.view(np.uint32), other.xyz.view(np.uint32)),
        "Y.stderr": (one.y_stderr.view(np.uint32), other.y_stderr.view(np.uint32)),
        "n": (one.samples, other.samples),
        "RGB": (one.rgb.view(np.uint32), other.rgb.view(np.uint32)),
    }
    assert one.further.keys() == other.further.keys()
    pairs |= {
        name: (one.further[name].view(np.uint32), other.further[name].view(np.uint32)) for name in one.further
    }
    assert all(a.shape == b.shape for a, b in pairs.values())
    counts = {name: int(np.count_nonzero(a != b)) for name, (a, b) in pairs.items()}
    return {name: count for name, count in counts.items() if count}
