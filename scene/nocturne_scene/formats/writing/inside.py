"""Whether a point is inside of a closed mesh."""

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.meshes.triangles import Triangles

# No edge of a scene made by people has this direction.
_ASKEW = np.array([0.4802871, 0.6120413, 0.6282357])


def crossings(mesh: Triangles, point: NDArray[np.float64]) -> int:
    """How many triangles a ray from a point meets (T. Moeller and B. Trumbore 1997)."""
    a, b, c = (mesh.vertices[mesh.indices[:, corner]] for corner in range(3))
    across = np.cross(_ASKEW, c - a)
    determinant = np.einsum("ij,ij->i", b - a, across)
    hit = determinant != 0
    inverse = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=hit)
    offset = point - a
    u = np.einsum("ij,ij->i", offset, across) * inverse
    turned = np.cross(offset, b - a)
    v = turned @ _ASKEW * inverse
    t = np.einsum("ij,ij->i", c - a, turned) * inverse
    return int(np.sum(hit & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)))
