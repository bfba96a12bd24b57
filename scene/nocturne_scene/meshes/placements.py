"""Where many copies of one thing stand: a PLY file with a vertex for each."""

from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, takewhile
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.meshes.headers import PLY_TYPES, UnusableMeshError, check_header

Numbers = NDArray[np.float64]

COLUMNS = ("x", "y", "z", "scale", "axis_x", "axis_y", "axis_z", "degrees")
"""What a vertex says, in metres and degrees; all but the first three may be missing."""

# Quarter turns are exact, as those in documents are.
_SINES, _COSINES = np.array([0.0, 1.0, 0.0, -1.0]), np.array([1.0, 0.0, -1.0, 0.0])


@dataclass(frozen=True)
class Placements:
    """Each does x -> scale R x + shift, with a rotation R."""

    scales: Numbers
    """Shape (n,)."""
    rotations: Numbers
    """Shape (n, 3, 3)."""
    shifts: Numbers
    """Shape (n, 3)."""

    def __len__(self) -> int:
        return len(self.scales)


def count_placements(path: Path) -> int:
    """How many a file has, by its header. Raises UnusableMeshError."""
    with path.open("rb") as file:
        return _header(file)[0]


def read_placements(path: Path) -> Placements:
    """All placements of a file. Raises UnusableMeshError."""
    with path.open("rb") as file:
        count, columns, order = _header(file)
        rows = _rows(file, count, columns, order)
    table = np.zeros((count, len(COLUMNS)))
    table[:, 3] = 1.0
    for index, name in enumerate(COLUMNS):
        if name in columns:
            table[:, index] = rows[name]
    return _checked(table)


def write_placements(path: Path, table: Numbers) -> None:
    """Write rows of all `COLUMNS`, shape (n, 8), in double precision."""
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(table)}"]
    header += [f"property double {name}" for name in COLUMNS]
    with path.open("wb") as file:
        file.write("\n".join([*header, "end_header", ""]).encode())
        file.write(np.ascontiguousarray(table, dtype="<f8").data)


def _header(file: BinaryIO) -> tuple[int, dict[str, str], str]:
    """Number of vertices, types by property, and the order of bytes, empty for text; the file stands at its
    first row."""
    check_header(file, "ply")
    count, columns, order, element = 0, dict[str, str](), "", ""
    for words in takewhile(lambda words: words != ["end_header"], _words(file)):
        match words:
            case ["format", kind, *_]:
                order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(kind, "")
            case ["element", name, number]:
                if not element and name != "vertex":
                    raise UnusableMeshError("placements are vertices, which come first in their file")
                element, count = name, int(number) if name == "vertex" else count
            case ["property", "list", *_] if element == "vertex":
                raise UnusableMeshError("a placement has numbers, and no lists")
            case ["property", kind, name] if element == "vertex":
                if name in columns:
                    raise UnusableMeshError(f'two properties are called "{name[:80]}"')
                columns[name] = PLY_TYPES[kind]
    if not count:
        raise UnusableMeshError("the file has no placements")
    rotation = [name for name in COLUMNS[4:] if name in columns]
    if len(rotation) not in (0, 4):
        missing = ", ".join(name for name in COLUMNS[4:] if name not in rotation)
        raise UnusableMeshError(f"a rotation has {', '.join(COLUMNS[4:])}; missing: {missing}")
    return count, columns, order


def _words(file: BinaryIO) -> Iterator[list[str]]:
    # Its end was seen by `check_header`.
    for line in file:
        yield line.decode("ascii", "replace").split()


def _rows(file: BinaryIO, count: int, columns: dict[str, str], order: str) -> NDArray[np.void]:
    if not order:
        return _lines(file, count, list(columns))
    kinds = np.dtype([(name, order + kind) for name, kind in columns.items()])
    content = file.read(count * kinds.itemsize)
    if len(content) < count * kinds.itemsize:
        raise UnusableMeshError(
            f"{count} placements take {count * kinds.itemsize} bytes, found {len(content)}"
        )
    return np.frombuffer(content, kinds, count)


def _lines(file: BinaryIO, count: int, names: list[str]) -> NDArray[np.void]:
    values = array("d")
    try:
        for line in islice(file, count):
            words = line.split()
            values.extend(map(float, words))
            if len(words) != len(names):
                raise ValueError
        if len(values) != count * len(names):
            raise ValueError
    except ValueError:
        raise UnusableMeshError(f"expected {count} lines of {len(names)} numbers") from None
    return np.frombuffer(values, np.dtype([(name, "f8") for name in names]))


def _checked(table: Numbers) -> Placements:
    wrong = np.flatnonzero(~np.isfinite(table).all(axis=1))
    if wrong.size:
        raise UnusableMeshError(f"placement {wrong[0]} has numbers that are not finite")
    scales, axes, degrees = table[:, 3], table[:, 4:7], table[:, 7]
    wrong = np.flatnonzero(scales <= 0)
    if wrong.size:
        raise UnusableMeshError(
            f"placement {wrong[0]} has a scale of {scales[wrong[0]]:g}; expected more than 0"
        )
    lengths = np.linalg.norm(axes, axis=1)
    wrong = np.flatnonzero((degrees != 0) & ~(lengths > 0))
    if wrong.size:
        raise UnusableMeshError(f"placement {wrong[0]} turns about an axis without length")
    lengths[degrees == 0] = 1.0
    return Placements(scales, _rotations(axes / lengths[:, None], degrees), table[:, :3])


def _rotations(axes: Numbers, degrees: Numbers) -> Numbers:
    """Rodrigues' formula: R = I + sin(a) K + (1 - cos(a)) K^2, K v = axis x v."""
    quarters = degrees / 90
    exact = quarters == np.floor(quarters)
    number = np.where(exact, quarters % 4, 0.0).astype(np.int64)
    sines = np.where(exact, _SINES[number], np.sin(np.deg2rad(degrees)))
    cosines = np.where(exact, _COSINES[number], np.cos(np.deg2rad(degrees)))
    cross = np.zeros((len(axes), 3, 3))
    x, y, z = axes.T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross[:, 1, 0], cross[:, 2, 0], cross[:, 2, 1] = z, -y, x
    turned = sines[:, None, None] * cross + (1 - cosines)[:, None, None] * (cross @ cross)
    return np.asarray(np.eye(3) + turned)
