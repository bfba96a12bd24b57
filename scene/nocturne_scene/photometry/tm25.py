"""Ray files, IES TM-25-13: the light of a lamp as rays from where it leaves it, read and written.

Little endian. A header of 256 bytes, eight flags of 32 bits, nine texts of 1000 characters of UTF-32,
spectral tables filled up to a multiple of 32 bytes, names of further columns of 512 bytes each, a text, and
the rays: float32, of each x, y, z in mm, a direction, and what the flags say.
"""

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.photometry.intensities import Spectrum

Rays = NDArray[np.float32]

VERSION = 2013
MAX_RAYS = 100_000_000
"""A file of so many has 3 GB; in a scene they take as much memory, and 8 bytes of each more."""

_HEADER = struct.Struct("<4siiffQ28siifffiii168x")
_FLAGS = struct.Struct("<8i")
_TEXTS, _TEXT_BYTES = 9, 4000
_COLUMN_NAME_BYTES = 512
_MAX_COLUMNS = 64
_MAX_TABLES = 10_000
_MAX_KNOTS = 100_000
_LARGEST = 1e18

# Spectral data identifier, section 4.7.1.9.
_NO_SPECTRUM, _ONE_WAVELENGTH, _OF_EACH_RAY, _ONE_TABLE, _TABLES = range(5)


class BadRayFileError(Exception):
    """The file can't be used; the message says at which byte, and why."""

    def __init__(self, at: int, message: str) -> None:
        super().__init__(f"byte {at}: {message}")
        self.at = at


@dataclass(frozen=True, eq=False)
class RayFile:
    """The rays of a lamp."""

    starts: Rays
    """m, shape (rays, 3)."""
    directions: Rays
    """Of length 1, shape (rays, 3)."""
    watts: Rays | None
    """Radiant flux of each; None: not in the file."""
    lumens: Rays | None
    """Luminous flux of each; None: not in the file."""
    wavelengths: Rays | None = None
    """nm, of each ray."""
    spectra: Sequence[Spectrum] = ()
    """Of any size."""
    spectrum_of: NDArray[np.int32] | None = None
    """Which of the spectra each ray has; without, all have the first."""
    texts: Sequence[str] = field(default=("",) * _TEXTS)
    """Lamp, manufacturer, creators of model and file, equipment, camera, operation, more, reference."""


def read(path: Path) -> RayFile:
    """Reads a file, whose rays stay in it until they are used. Raises BadRayFileError, and OSError."""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = _Head(file.read(min(size, _BEFORE_TABLES + 8 * _MAX_TABLES * 64)), size)
    columns = head.columns()
    count, start = head.rays, head.end
    if start + 4 * len(columns) * count != size:
        raise BadRayFileError(
            start,
            f"{count} rays of {len(columns)} numbers need {4 * len(columns) * count} bytes, and "
            f"{size - start} follow",
        )
    table = np.memmap(path, dtype="<f4", mode="r", offset=start, shape=(count, len(columns)))
    return _checked(head, columns, table, start)


_BEFORE_TABLES = _HEADER.size + _FLAGS.size + _TEXTS * _TEXT_BYTES


class _Head:
    """All before the rays."""

    def __init__(self, data: bytes, size: int) -> None:
        if len(data) < _BEFORE_TABLES:
            raise BadRayFileError(len(data), f"the file ends; expected a head of {_BEFORE_TABLES} bytes")
        magic, version, *numbers = _HEADER.unpack_from(data)
        if magic != b"TM25" or version != VERSION:
            raise BadRayFileError(0, f"expected TM25 and {VERSION}, found {magic!r} and {version}")
        self.rays, self.kind, self.wavelength = numbers[3], numbers[6], numbers[7]
        tables, self.further, text = numbers[10:13]
        if not 1 <= self.rays <= MAX_RAYS:
            raise BadRayFileError(20, f"{self.rays} rays; expected 1 to {MAX_RAYS}")
        if not 0 <= self.kind <= _TABLES:
            raise BadRayFileError(60, f"the spectral data identifier is {self.kind}; expected 0 to {_TABLES}")
        if self.kind == _ONE_WAVELENGTH and not 0 < self.wavelength < _LARGEST:
            raise BadRayFileError(64, f"the wavelength is {self.wavelength:g}; expected one in nm")
        least = 1 if self.kind in (_ONE_TABLE, _TABLES) else 0
        if not least <= tables <= _MAX_TABLES:
            raise BadRayFileError(76, f"{tables} spectral tables; expected {least} to {_MAX_TABLES}")
        if not 0 <= self.further <= _MAX_COLUMNS:
            raise BadRayFileError(80, f"{self.further} further columns; expected 0 to {_MAX_COLUMNS}")
        if not 0 <= text <= size:
            raise BadRayFileError(84, f"a text of {text} bytes; expected one that fits into the file")
        self.flags = _FLAGS.unpack_from(data, _HEADER.size)
        self._check_flags()
        texts = _HEADER.size + _FLAGS.size
        self.texts = [_text(data[texts + i * _TEXT_BYTES :][:_TEXT_BYTES]) for i in range(_TEXTS)]
        at = _BEFORE_TABLES
        self.spectra = []
        for _ in range(tables):
            spectrum, at = _table(data, at)
            self.spectra.append(spectrum)
        at += -(at - _BEFORE_TABLES) % 32
        self.end = at + self.further * _COLUMN_NAME_BYTES + text
        if self.end > size:
            raise BadRayFileError(at, f"the file ends at {size} before the rays")

    def _check_flags(self) -> None:
        for index, flag in enumerate(self.flags):
            if flag not in (0, 1) or (index < 2 and not flag):
                raise BadRayFileError(
                    _HEADER.size + 4 * index,
                    f"a flag of known data is {flag}; expected {'1' if index < 2 else '0 or 1'}",
                )
        _, _, watts, wavelength, lumens, *_, index = self.flags
        if not (watts or lumens):
            raise BadRayFileError(_HEADER.size + 8, "rays without flux; expected a radiant or luminous one")
        if self.kind == _OF_EACH_RAY and not wavelength:
            raise BadRayFileError(_HEADER.size + 12, "rays without wavelengths, which their identifier needs")
        if (self.kind == _TABLES) != bool(index):
            raise BadRayFileError(_HEADER.size + 28, "indices of spectra and their identifier disagree")

    def columns(self) -> list[str]:
        """Names of the numbers of each ray."""
        found = ["x", "y", "z", "kx", "ky", "kz"]
        of_flags = (
            ["watts"],
            ["nm"],
            ["lumens"],
            ["s1", "s2", "s3", "px", "py", "pz"],
            ["X", "Z"],
            ["index"],
        )
        for flag, names in zip(self.flags[2:], of_flags, strict=True):
            found += names if flag else []
        return found + [f"further {index}" for index in range(self.further)]


def _text(data: bytes) -> str:
    return data.decode("utf-32-le", "replace").partition("\0")[0]


def _table(data: bytes, at: int) -> tuple[Spectrum, int]:
    """A spectral table, and where the next one is."""
    if at + 4 > len(data):
        raise BadRayFileError(at, "the file ends before a spectral table")
    count = int.from_bytes(data[at : at + 4], "little", signed=True)
    end = at + 4 + 8 * count
    if not 1 <= count <= _MAX_KNOTS or end > len(data):
        raise BadRayFileError(
            at, f"a spectral table of {count} pairs; expected 1 to {_MAX_KNOTS}, in the file"
        )
    pairs = (
        np.frombuffer(data, dtype="<f4", count=2 * count, offset=at + 4).reshape(count, 2).astype(np.float64)
    )
    nm, values = pairs.T
    good = np.all(np.isfinite(pairs)) and np.all(nm > 0) and np.all(np.diff(nm) > 0) and np.all(values >= 0)
    if not good or not values.max() > 0:
        raise BadRayFileError(
            at, "a spectral table; expected increasing wavelengths, and powers, not all zero"
        )
    return (nm, values / values.max()), end


def _checked(head: _Head, columns: list[str], table: Rays, start: int) -> RayFile:
    def column(*names: str) -> Rays:
        return table[:, [columns.index(name) for name in names]]

    def fail(bad: NDArray[np.bool_], message: str) -> None:
        if bad.any():
            ray = int(np.flatnonzero(bad)[0])
            raise BadRayFileError(start + 4 * len(columns) * ray, f"ray {ray + 1}: {message}")

    starts, directions = column("x", "y", "z"), column("kx", "ky", "kz")
    lengths = np.linalg.norm(directions.astype(np.float64), axis=1)
    fail(~np.all(np.abs(starts) <= _LARGEST, axis=1), "expected a place, x, y and z in mm")
    fail(~(np.abs(lengths - 1.0) < 0.01), "expected a direction of length 1")
    fluxes = {}
    for name, flag in (("watts", head.flags[2]), ("lumens", head.flags[4])):
        fluxes[name] = column(name)[:, 0] if flag else None
        if flag:
            fail(
                ~((column(name)[:, 0] >= 0) & (column(name)[:, 0] <= _LARGEST)),
                f"expected {name}, not negative",
            )
            if not np.any(column(name) > 0):
                raise BadRayFileError(start, f"no ray has any {name}")
    wavelengths = spectrum_of = None
    if head.kind == _OF_EACH_RAY:
        wavelengths = column("nm")[:, 0]
        fail(~((wavelengths > 0) & (wavelengths <= 1e6)), "expected a wavelength in nm")
    if head.kind == _ONE_WAVELENGTH:
        wavelengths = np.full(len(table), head.wavelength, dtype=np.float32)
    if head.kind == _TABLES:
        index = column("index")[:, 0]
        fail(
            ~((index >= 1) & (index <= len(head.spectra)) & (index == np.floor(index))),
            "expected a spectrum's index",
        )
        spectrum_of = index.astype(np.int32) - 1
    spectra = head.spectra if head.kind in (_ONE_TABLE, _TABLES) else []
    places = (starts.astype(np.float64) / 1000.0).astype(np.float32)
    unit = (directions / lengths[:, None]).astype(np.float32)
    return RayFile(
        places, unit, fluxes["watts"], fluxes["lumens"], wavelengths, spectra, spectrum_of, head.texts
    )


def write(path: Path, rays: RayFile) -> None:
    """Writes a file; equal rays give equal bytes, as it has no time. Raises OSError."""
    watts, lumens, wavelengths = rays.watts, rays.lumens, rays.wavelengths
    kind = _NO_SPECTRUM
    if rays.spectra:
        kind = _ONE_TABLE if rays.spectrum_of is None else _TABLES
    elif wavelengths is not None:
        kind = _OF_EACH_RAY
    none = math.nan
    totals = [none if each is None else float(each.sum(dtype=np.float64)) for each in (lumens, watts)]
    span = [none, none]
    if wavelengths is not None and kind == _OF_EACH_RAY:
        span = [float(wavelengths.min()), float(wavelengths.max())]
    elif rays.spectra:
        span = [min(float(nm[0]) for nm, _ in rays.spectra), max(float(nm[-1]) for nm, _ in rays.spectra)]
    by_rays = kind == _OF_EACH_RAY
    head = _HEADER.pack(
        b"TM25",
        VERSION,
        0,
        *totals,
        len(rays.starts),
        b"not said",
        0,
        kind,
        none,
        *span,
        len(rays.spectra),
        0,
        0,
    )
    flags = (1, 1, watts is not None, by_rays, lumens is not None, 0, 0, kind == _TABLES)
    columns = [1000.0 * rays.starts.astype(np.float64), rays.directions]
    columns += [
        each[:, None] for each in (watts, wavelengths if by_rays else None, lumens) if each is not None
    ]
    if kind == _TABLES and rays.spectrum_of is not None:
        columns.append(rays.spectrum_of[:, None] + 1)
    with path.open("wb") as file:
        file.write(head + _FLAGS.pack(*map(int, flags)))
        for text in (*rays.texts, *("",) * _TEXTS)[:_TEXTS]:
            file.write(text[: _TEXT_BYTES // 4 - 1].encode("utf-32-le").ljust(_TEXT_BYTES, b"\0"))
        tables = b"".join(
            struct.pack("<i", len(nm)) + np.stack([nm, values], axis=1).astype("<f4").tobytes()
            for nm, values in rays.spectra
        )
        file.write(tables + bytes(-len(tables) % 32))
        file.write(
            np.concatenate([np.asarray(each, dtype=np.float64) for each in columns], axis=1)
            .astype("<f4")
            .tobytes()
        )
