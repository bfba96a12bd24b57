"""Files that a scene names, by SHA-256."""

import hashlib
import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Indices = NDArray[np.int32]
Json = Any


class Files:
    """Files that the service needs before the scene."""

    def __init__(self) -> None:
        self.by_digest: dict[str, bytes] = {}

    def add(self, content: bytes) -> str:
        """How a document refers to a file."""
        digest = hashlib.sha256(content).hexdigest()
        self.by_digest[digest] = content
        return f"sha256:{digest}"


def ply(
    vertices: Floats, triangles: Indices, normals: Floats | None = None, coordinates: Floats | None = None
) -> bytes:
    """A binary PLY file: shapes (n, 3), (m, 3), (n, 3) and (n, 2)."""
    columns, names = [vertices], ["x", "y", "z"]
    if normals is not None:
        columns.append(normals)
        names += ["nx", "ny", "nz"]
    if coordinates is not None:
        columns.append(coordinates)
        names += ["s", "t"]
    header = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {len(vertices)}",
        *(f"property float {name}" for name in names),
        f"element face {len(triangles)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    rows = np.hstack(columns).astype("<f4")
    return ("\n".join(header) + "\n").encode() + rows.tobytes() + faces.tobytes()


def placements(places: list[Json]) -> bytes:
    """A binary PLY file of where things stand; each as fields of a document, without motion."""
    names = ("x", "y", "z", "scale", "axis_x", "axis_y", "axis_z", "degrees")
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(places)}"]
    header += [*(f"property double {name}" for name in names), "end_header"]
    rows = np.zeros((len(places), len(names)))
    for row, each in zip(rows, places, strict=True):
        turn = each.get("rotate", {"axis": (0.0, 0.0, 0.0), "degrees": 0.0})
        row[:] = (
            *each.get("translate", (0.0, 0.0, 0.0)),
            each.get("scale", 1.0),
            *turn["axis"],
            turn["degrees"],
        )
    return ("\n".join(header) + "\n").encode() + rows.astype("<f8").tobytes()


def exr(pixels: Floats) -> bytes:
    """An OpenEXR file of 32-bit floats without compression, shape (height, width, 3), top row first.

    Red, green, blue. The layout: "OpenEXR File Layout", openexr.com.
    """
    height, width, _ = pixels.shape
    channels = (
        b"".join(name + b"\0" + struct.pack("<iBxxxii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    )
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = (
        (b"channels", b"chlist", channels),
        (b"compression", b"compression", b"\0"),
        (b"dataWindow", b"box2i", window),
        (b"displayWindow", b"box2i", window),
        (b"lineOrder", b"lineOrder", b"\0"),
        (b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        (b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)),
        (b"screenWindowWidth", b"float", struct.pack("<f", 1)),
    )
    head = struct.pack("<ii", 20000630, 2) + b"".join(
        name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value
        for name, kind, value in attributes
    )
    head += b"\0"
    rows = np.empty(height, dtype=[("y", "<i4"), ("size", "<i4"), ("pixels", "<f4", (3, width))])
    rows["y"], rows["size"] = np.arange(height), 12 * width
    rows["pixels"] = pixels[..., ::-1].transpose(0, 2, 1)
    offsets = len(head) + 8 * height + rows.itemsize * np.arange(height)
    return b"".join((head, offsets.astype("<u8").tobytes(), rows.tobytes()))


def png(pixels: NDArray[np.uint8]) -> bytes:
    """A PNG file of shape (height, width, channels), top row first; one, three or four channels."""
    height, width, channels = pixels.shape
    kind = {1: 0, 3: 2, 4: 6}[channels]
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)

    def chunk(name: bytes, content: bytes) -> bytes:
        body = name + content
        return struct.pack(">I", len(content)) + body + struct.pack(">I", zlib.crc32(body))

    head = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6))
        + chunk(b"IEND", b"")
    )


def spot_photometry(cone: float, blend: float, candela: float) -> bytes:
    """A photometric file (IES LM-63-2002, type C) of a spot lamp.

    `cone`: its full angle in radians. `blend`: the part of the cosine between axis and edge over which the
    intensity falls to nothing, by the smooth step 3 t^2 - 2 t^3. `candela`: on the axis.
    """
    edge = np.cos(cone / 2)
    inner = np.arccos(np.clip(edge + (1 - edge) * blend, -1, 1))
    half = cone / 2
    angles = np.unique(
        np.round(
            np.degrees(
                np.concatenate(
                    [np.linspace(0, inner, 16), np.linspace(inner, half, 160), [half + 1e-4, np.pi]]
                )
            ),
            4,
        )
    )
    cosines = np.cos(np.radians(angles))
    if blend > 0:
        t = np.clip((cosines - edge) / ((1 - edge) * blend), 0, 1)
        values = candela * t * t * (3 - 2 * t)
    else:
        values = np.where(angles <= np.degrees(half) + 5e-5, candela, 0.0)
    head = f"1 -1 1 {len(angles)} 1 1 2 0 0 0\n1 1 0\n"
    lines = [" ".join(f"{number:.7g}" for number in part) for part in (angles, [0.0], values)]
    return ("IESNA:LM-63-2002\nTILT=NONE\n" + head + "\n".join(lines) + "\n").encode()
