"""State of one compilation: the document, made blobs, used and dropped parts, and problems."""

import hashlib
import json
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Generic, TypeVar

from nocturne.v1 import scene_pb2

from nocturne_scene.blobs import BlobStore, NoteKey
from nocturne_scene.compile import spectra
from nocturne_scene.compile.light_groups import LightGroups
from nocturne_scene.document import bounds
from nocturne_scene.document.checks import resolve_spectrum
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.node import NAMED
from nocturne_scene.document.problems import path
from nocturne_scene.document.shapes import DIGEST_PREFIX
from nocturne_scene.document.spectra import LineSpectrum, Spectrum
from nocturne_scene.errors import InputError, NotFound, Problem
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.placements import Placements, count_placements, read_placements
from nocturne_scene.meshes.similarity import IDENTITY
from nocturne_scene.spectra import indices
from nocturne_scene.spectra import lines as line_spectra
from nocturne_scene.spectra.wavelength_range import WavelengthRange

_Message = TypeVar("_Message", scene_pb2.Spectrum, scene_pb2.Kernel, scene_pb2.Interior, scene_pb2.Texture)


class Unusable(Exception):
    """A part of the document can't be compiled; `suffix` leads to the culprit from where the part is."""

    def __init__(self, message: str, suffix: str = "") -> None:
        self.suffix = suffix
        super().__init__(message)


class Pool(Generic[_Message]):
    """Messages without duplicates, in order of first use."""

    def __init__(self) -> None:
        self._index_by_bytes: dict[bytes, int] = {}
        self.messages: list[_Message] = []

    def index_of(self, message: _Message) -> int:
        """Return the index of an equal message, added if there is none."""
        key = message.SerializeToString(deterministic=True)
        if key not in self._index_by_bytes:
            self._index_by_bytes[key] = len(self.messages)
            self.messages.append(message)
        return self._index_by_bytes[key]


class Workspace:
    """The state of one compilation."""

    def __init__(self, document: SceneDocument, blobs: BlobStore) -> None:
        self.document = document
        self.wavelengths = document.wavelength_range
        """What the sensor sees."""
        self.spectral: WavelengthRange = document.wavelength_range.with_visible
        """Over which spectra are compiled: also what scales them to a luminance."""
        self.frame = IDENTITY
        """Comes after every placement; see origin.py."""
        self.blobs = blobs
        self.packed: dict[bytes, bytes] = {}
        """Blobs to be written once all is well, by digest."""
        self.files: dict[bytes, Path] = {}
        """The same of blobs that are too large for memory."""
        self.notes: dict[NoteKey, str] = {}
        """Notes by their subject, for the blob store once the blobs are written."""
        self.objects: list[str] = []
        """Of the message's surfaces, their names or places."""
        self.dropped: list[str] = []
        self.warnings: list[str] = []
        self.problems: list[Problem] = []
        self.light_groups = LightGroups(document)
        self.photons_can_start = True
        """At all luminaires, for forward photons."""
        self.spectra: Pool[scene_pb2.Spectrum] = Pool()
        self.kernels: Pool[scene_pb2.Kernel] = Pool()
        self.interiors: Pool[scene_pb2.Interior] = Pool()
        self.textures: Pool[scene_pb2.Texture] = Pool()
        self._placements: dict[str, Placements] = {}
        self._used: set[tuple[str, str]] = set()
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    @contextmanager
    def problems_at(self, place: str) -> Iterator[None]:
        """Note a part that can't be used, and go on after the block."""
        try:
            yield
        except Unusable as error:
            self.problems.append(Problem(place + error.suffix, str(error)))
        except (UnusableMeshError, spectra.NotCompilableError, indices.BadIndexError) as error:
            self.problems.append(Problem(place, str(error)))

    @property
    def has_too_many_problems(self) -> bool:
        """Whether more of them help nobody."""
        return len(self.problems) >= bounds.PROBLEMS

    def use(self, collection: str, name: str) -> None:
        """Note that something refers to an entry of a collection."""
        self._used.add((collection, name))

    def spectrum(self, reference: str | float | Spectrum) -> Spectrum:
        """Return the spectrum that a reference stands for."""
        if isinstance(reference, str):
            self.use("spectra", reference)
        return resolve_spectrum(self.document, reference)

    def reflectance(self, reference: str | float | Spectrum) -> int:
        """Return the index of a spectrum that is held beyond its table."""
        return self.spectra.index_of(spectra.reflectance(self.spectrum(reference), self.spectral))

    def is_used(self, collection: str, name: str) -> bool:
        """Whether something that was compiled so far refers to an entry of a collection."""
        return (collection, name) in self._used

    @property
    def light(self) -> str:
        """What the sensor sees, in words."""
        return "visible light" if self.wavelengths.is_usual else f"light from {self.wavelengths}"

    def is_dark(self, spectrum: scene_pb2.Spectrum) -> bool:
        """Whether a compiled radiance has nothing that the sensor may see."""
        return spectra.is_dark(spectrum, self.wavelengths)

    def keep(self, data: bytes) -> bytes:
        """Remember a blob and return its digest."""
        digest = hashlib.sha256(data).digest()
        self.packed[digest] = data
        return digest

    def temporary(self, name: str) -> Path:
        """Return where a file may be written; it is gone at the end of the compilation."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="nocturne-")
        return Path(tempfile.mkdtemp(dir=self._folder.name)) / name

    def keep_file(self, file: Path) -> bytes:
        """Remember a blob in a file of `temporary` and return its digest."""
        with file.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").digest()
        self.files[digest] = file
        return digest

    def made_before(self, about: NoteKey) -> tuple[bytes, Any] | None:
        """Digest of the blob that was made for an earlier scene, and facts about it; None if it is gone."""
        try:
            blob, facts = json.loads(self.blobs.note(about) or "")
            if self.blobs.has(blob):
                self.blobs.touch(blob)
                return bytes.fromhex(blob), facts
        except (ValueError, TypeError, InputError):
            # A damaged note is no note.
            pass
        return None

    def note_made(self, about: NoteKey, blob: bytes, facts: Any) -> None:
        """Note for later scenes which blob was made, `facts` being what JSON can hold."""
        self.notes[about] = json.dumps([blob.hex(), facts])

    def found_before(self, about: NoteKey) -> Any:
        """The facts that were noted for an earlier scene; None if there are none."""
        try:
            return json.loads(self.blobs.note(about) or "null")
        except ValueError:
            # A damaged note is no note.
            return None

    def note_found(self, about: NoteKey, facts: Any) -> None:
        """Note facts for later scenes, in a form that JSON can hold."""
        self.notes[about] = json.dumps(facts)

    def write_blobs(self) -> None:
        """Put all that was kept into the blob store."""
        for packed in self.packed.values():
            self.blobs.put(packed)
        for digest, file in self.files.items():
            self.blobs.put_file(digest.hex(), file)
        for about, text in self.notes.items():
            self.blobs.put_note(about, text)

    def clean_up(self) -> None:
        """Remove files of `temporary`."""
        if self._folder is not None:
            self._folder.cleanup()

    def asset(self, reference: str, suffix: str = "") -> bytes:
        """Return the digest of an asset, 32 bytes; raises Unusable, also if it was not uploaded."""
        if not reference.startswith(DIGEST_PREFIX):
            raise Unusable(
                f'expected "{DIGEST_PREFIX}" and the digest of an uploaded file; the service has no paths',
                suffix,
            )
        digest = reference.removeprefix(DIGEST_PREFIX)
        try:
            self.blobs.path(digest)
        except (NotFound, InputError) as error:
            raise Unusable(str(error), suffix) from None
        return bytes.fromhex(digest)

    def read(self, digest: bytes, maximum: int) -> bytes:
        """Return at most one byte more than `maximum` of an asset, so that its reader can refuse it."""
        with self.blobs.path(digest.hex()).open("rb") as file:
            return file.read(maximum + 1)

    def placements(self, asset: str) -> Placements:
        """Return those of a file, read once. Raises Unusable and UnusableMeshError."""
        if asset not in self._placements:
            if (count := self.count_placements(asset)) > bounds.FLATTENED_INSTANCES:
                raise Unusable(f"has {count} placements; at most {bounds.FLATTENED_INSTANCES}")
            self._placements[asset] = read_placements(self.blobs.path(self.asset(asset).hex()))
        return self._placements[asset]

    def count_placements(self, asset: str) -> int:
        """How many a file has. Raises Unusable and UnusableMeshError."""
        return count_placements(self.blobs.path(self.asset(asset).hex()))

    def report_unseen(self, reference: object, place: str) -> None:
        """Add the lines of a spectrum that nobody sees; a named one's once."""
        spectrum = reference
        if isinstance(reference, str):
            place, spectrum = path(("spectra", reference)), self.document.spectra[reference]
        if not isinstance(spectrum, LineSpectrum):
            return
        for number, line in enumerate(spectra.line_messages(spectrum)):
            report = f"{place}.lines[{number}]: lies outside of {self.wavelengths}"
            if not line_spectra.is_within(line, self.wavelengths) and report not in self.dropped:
                self.dropped.append(report)

    def report_motion(self, motion: object, steps: int, place: str) -> None:
        """Add a motion that has one step only, once."""
        report = f"{place}.motion: moves nothing"
        if motion is not None and steps == 1 and report not in self.dropped:
            self.dropped.append(report)

    def report_unused(self) -> None:
        """Add the entries of collections that nothing refers to."""
        for collection in NAMED:
            names = sorted(getattr(self.document, collection))
            unused = [name for name in names if (collection, name) not in self._used]
            self.dropped.extend(f"{path((collection, name))}: nothing uses it" for name in unused)
