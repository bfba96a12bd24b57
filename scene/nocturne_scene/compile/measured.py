"""Measured reflections as the table that the tracer reads: docs/how-to/measured-brdf.md."""

import json
import math
import struct

import numpy as np

from nocturne_scene.blobs import NoteKey
from nocturne_scene.compile import merl
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.kernels import Measured
from nocturne_scene.spectra import published

# Magic; uint32 version, nodes of theta_h, theta_d, phi_d, planes, basis; float32 first wavelength and step.
_HEADER = struct.Struct("<8s6I2f")
_MAGIC = b"NOCTBRDF"
_VERSION = 1
_MAX_ALONG = 4096

_CONVERSION = 1
"""Number of how files of MERL become tables; raised with every change of that, since tables are kept."""

_MAX_VALUES = 2**26


def compile_measured(workspace: Workspace, kernel: Measured) -> bytes:
    """Return the digest of the table; raises Unusable."""
    digest = workspace.asset(kernel.asset, ".asset")
    try:
        if kernel.format == "table":
            _check_table(workspace, digest)
            return digest
        about = NoteKey(digest.hex(), json.dumps(["merl", _CONVERSION]))
        if (before := workspace.made_before(about)) is not None:
            return before[0]
        table = workspace.keep(_from_merl(workspace.read(digest, merl.FILE_BYTES)))
        workspace.note_made(about, table, None)
        return table
    except merl.BadMerlError as error:
        raise Unusable(str(error), ".asset") from None


def _from_merl(data: bytes) -> bytes:
    """Red, green and blue become weights of three reflectances that add up to 1."""
    values = merl.read(data)
    wavelengths, basis = published.srgb_basis()
    header = _HEADER.pack(
        _MAGIC,
        _VERSION,
        *values.shape[1:],
        3,
        len(basis),
        wavelengths[0],
        wavelengths[1] - wavelengths[0],
    )
    return header + basis.astype("<f4").tobytes() + values.astype("<f4").tobytes()


def _check_table(workspace: Workspace, digest: bytes) -> None:
    size = workspace.blobs.size(digest.hex())
    with workspace.blobs.path(digest.hex()).open("rb") as file:
        head = file.read(_HEADER.size)
    if len(head) < _HEADER.size or head[:8] != _MAGIC:
        raise Unusable(f'no table: it does not begin with "{_MAGIC.decode()}" and sizes', ".asset")
    _, version, *counts, basis, first, step = _HEADER.unpack(head)
    if version != _VERSION:
        raise Unusable(f"a table of version {version}; expected {_VERSION}", ".asset")
    if not all(1 <= count <= _MAX_ALONG for count in counts) or math.prod(counts) > _MAX_VALUES:
        shown = " x ".join(str(count) for count in counts)
        raise Unusable(f"a table of {shown} values; at most {_MAX_VALUES} are accepted", ".asset")
    if basis and (counts[3] != 3 or not 2 <= basis <= _MAX_ALONG):
        raise Unusable(f"{basis} basis spectra entries with {counts[3]} planes; expected 3 planes", ".asset")
    if not (np.isfinite(first) and np.isfinite(step) and step > 0):
        raise Unusable("a table without a positive step of wavelengths", ".asset")
    expected = _HEADER.size + 4 * (math.prod(counts) + 3 * basis)
    if size != expected:
        raise Unusable(f"the table has {size} bytes; its sizes say {expected}", ".asset")
