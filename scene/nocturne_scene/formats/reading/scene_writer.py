"""Collects a scene document and its files, checks them as the service would, and writes them to a folder."""

import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene import limits
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError, Problem
from nocturne_scene.formats.reading import shapes
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.library_words import said_by
from nocturne_scene.meshes.triangles import Triangles, has_area

Json = Any
DOCUMENT = "scene.json"

# Pixels across the squares of a board: their edges are blurred over 1/512 of its period.
_BOARD = 512

# Of a step of 1/255, what single precision may be off by.
_STEP = 1e-3

# Characters of a name that an import makes up.
_NAME_LENGTH = 60


@dataclass
class FilmSettings:
    """What a scene file says of its image; no part of a scene document."""

    width: int = 512
    height: int = 512
    samples: int | None = None


@dataclass
class SceneWriter:
    """A scene in progress; files go below `folder` as they are made."""

    folder: Path
    document: dict[str, Json] = field(default_factory=lambda: {"nocturne": 1})
    film: FilmSettings = field(default_factory=FilmSettings)
    _names: dict[str, int] = field(default_factory=dict)
    """Names that are taken, each with the last number that was tried behind it."""
    _copied: dict[Path, str] = field(default_factory=dict)
    boxes: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    """Of meshes by the names of their files: lowest and highest corner."""
    _unseen: set[str] = field(default_factory=set)
    """Meshes none of whose triangles has an area."""

    def add(self, collection: str, entry: Json) -> None:
        """Append to a list of the document."""
        self.document.setdefault(collection, []).append(entry)

    def name(self, collection: str, wanted: str, entry: Json) -> str:
        """Put `entry` under a name like `wanted` and return that."""
        name = self._unused(wanted, collection)
        self.document.setdefault(collection, {})[name] = entry
        return name

    def mesh(self, wanted: str, mesh: Triangles) -> Json:
        """Write a mesh and return its shape. Raises InputError where it has no place in space."""
        # Also in single precision, in which it is written.
        if not np.all(np.isfinite(mesh.vertices.astype(np.float32))):
            raise InputError.at(wanted, "coordinates of the mesh are not finite, or too large")
        name = f"meshes/{self._unused(wanted, 'meshes')}.ply"
        self.file(name, shapes.ply(mesh))
        if len(mesh.vertices):
            self.boxes[name] = np.stack([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])
        if len(mesh.indices) and not np.any(has_area(mesh.vertices.astype(np.float32), mesh.indices)):
            self._unseen.add(name)
        return {"type": "mesh", "asset": name, "smooth": mesh.normals is not None}

    def picture(self, wanted: str, pixels: NDArray[np.float64], *, narrow: bool = False) -> str:
        """Write a picture of shape (height, width, 1 or 3) and return its name.

        `narrow`: in 16-bit floats, as compiled textures of 8-bit pictures are, too; numbers that have eight
        bits as a PNG.
        """
        height, width, channels = pixels.shape
        as_bytes = narrow and channels == 1 and _has_eight_bits(pixels)
        name = f"textures/{self._unused(wanted, 'textures.files')}.{'png' if as_bytes else 'exr'}"
        path = self._path(name)
        kind = oiio.UINT8 if as_bytes else oiio.HALF if narrow else oiio.FLOAT
        spec = oiio.ImageSpec(width, height, channels, kind)
        if not as_bytes:
            spec.attribute("compression", "zip")
        output = oiio.ImageOutput.create(str(path))
        if output is None or not output.open(str(path), spec):
            raise InputError.at(name, f"can't be written: {said_by(oiio.geterror)}")
        output.write_image(np.ascontiguousarray(pixels, dtype=np.float32))
        output.close()
        return name

    def board(self, first: Sequence[float], second: Sequence[float]) -> str:
        """Make a texture of two by two squares of linear sRGB, `first` at the top left; return its name."""
        channels = 1 if all(len(set(colour)) == 1 for colour in (first, second)) else 3
        half = np.arange(_BOARD) >= _BOARD // 2
        chosen = (half[:, None] != half[None, :]).astype(int)
        asset = self.picture("board", np.array([first, second])[chosen][..., :channels])
        return self.name("textures", "board", {"asset": asset, "encoding": "linear", "sharp": True})

    def copy(self, file: Path) -> str:
        """Copy a file as it is, once, and return its name."""
        if file not in self._copied:
            name = f"textures/{self._unused(file.stem, 'textures.files')}{file.suffix.lower()}"
            shutil.copyfile(file, self._path(name))
            self._copied[file] = name
        return self._copied[file]

    def file(self, name: str, content: bytes) -> str:
        """Write a file of that name and return the name."""
        self._path(name).write_bytes(content)
        return name

    def unused_file(self, folder: str, wanted: str, end: str) -> str:
        """Return the name of a file below a folder that is made for it."""
        name = f"{folder}/{self._unused(wanted, folder)}{end}"
        self._path(name)
        return name

    def leave_out_unseen(self, findings: Findings) -> None:
        """Leave out meshes none of whose triangles has an area, where something else is left."""
        lists = [self.document.get("surfaces", []), *self.document.get("groups", {}).values()]
        for surfaces in lists:
            # Of a group instances, too, which have no shape.
            seen = [each for each in surfaces if each.get("shape", {}).get("asset") not in self._unseen]
            if seen and len(seen) < len(surfaces):
                findings.note("", f"{len(surfaces) - len(seen)} meshes without an area are left out")
                surfaces[:] = seen

    def finish(self) -> tuple[Problem, ...]:
        """Write the document and return its problems. Raises InputError for one that is no JSON."""
        problems: tuple[Problem, ...] = ()
        try:
            check_document(self.document)
        except InputError as error:
            problems = error.problems
        try:
            content = self._text(indent=1)
            if len(content) > limits.MAX_SCENE_BYTES:
                content = self._text(separators=(",", ":"))
        except ValueError:
            raise InputError(problems) from None
        (self.folder / DOCUMENT).write_bytes(content)
        if len(content) > limits.MAX_SCENE_BYTES:
            said = f"is too long with {len(content):,} bytes; at most {limits.MAX_SCENE_BYTES:,} are accepted"
            problems = (Problem("$", said), *problems)
        return problems

    def _text(self, **form: Json) -> bytes:
        text = json.dumps(self.document, ensure_ascii=False, allow_nan=False, **form)
        return f"{text}\n".encode()

    def _path(self, name: str) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def _unused(self, wanted: str, collection: str) -> str:
        letters = (c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in wanted[:_NAME_LENGTH])
        plain = "".join(letters).lstrip("-") or "unnamed"
        name = plain
        while (key := f"{collection}/{name}") in self._names:
            # Those of this name with a lower number are taken.
            first = f"{collection}/{plain}"
            self._names[first] += 1
            name = f"{plain}-{self._names[first]}"
        self._names[key] = 1
        return name


def _has_eight_bits(values: NDArray[np.float64]) -> bool:
    """Whether values are from 0 to 1 in steps of 1/255."""
    steps = values * 255
    return bool(np.all((steps > -_STEP) & (steps < 255 + _STEP) & (np.abs(steps - np.rint(steps)) < _STEP)))
