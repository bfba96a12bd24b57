"""Values at the corners of triangles as a picture, with texture coordinates made for it.

Each triangle gets a block of 2 x 2 texels that holds the plane through the values at its corners, which lie
on the centres of three of them: bilinear interpolation is then exactly linear over the triangle.
"""

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.meshes.triangles import Triangles

_Array = NDArray[np.float64]
_BLOCK = 2
# Texels along an edge.
_MAX_EDGE = 16384

LOOKUP = {"wrap": "clamp", "sharp": True}
"""Fields of textures of such pictures, which are linear."""


def bake(mesh: Triangles, corners: _Array, name: str) -> tuple[Triangles, _Array]:
    """Return a mesh with new coordinates, and the picture for them.

    `corners`: what to show at the corners of each triangle, shape (triangles, 3, channels).
    """
    count, channels = len(corners), corners.shape[2]
    columns = int(np.ceil(np.sqrt(count)))
    rows = -(-count // columns)
    if columns * _BLOCK > _MAX_EDGE:
        raise InputError.at("", f"{name} has more triangles than a texture can hold")
    # Values at texel (i, j) of a block, corners at (0, 0), (1, 0), (0, 1).
    across, down = np.meshgrid(np.arange(_BLOCK), np.arange(_BLOCK))
    a, b, c = (corners[:, corner, None, None, :] for corner in range(3))
    blocks = a + across[..., None] * (b - a) + down[..., None] * (c - a)
    padded = np.zeros((rows * columns, _BLOCK, _BLOCK, channels))
    padded[:count] = blocks
    picture = padded.reshape(rows, columns, _BLOCK, _BLOCK, channels).swapaxes(1, 2)
    height, width = rows * _BLOCK, columns * _BLOCK
    row, column = np.divmod(np.arange(count), columns)
    texels = np.array([[0.5, 0.5], [1.5, 0.5], [0.5, 1.5]])
    x = (column[:, None] * _BLOCK + texels[:, 0]) / width
    y = (row[:, None] * _BLOCK + texels[:, 1]) / height
    corner = mesh.indices.ravel()
    return (
        Triangles(
            mesh.vertices[corner],
            np.arange(3 * count).reshape(-1, 3),
            None if mesh.normals is None else mesh.normals[corner],
            np.stack([x.ravel(), 1 - y.ravel()], 1),
        ),
        picture.reshape(height, width, channels),
    )
