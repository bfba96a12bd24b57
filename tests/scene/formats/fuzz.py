"""python -m tests.scene.formats.fuzz [--seconds 600] [READER...]: import files made wrong, for so long.

Each reader works in a separate process with bounded memory, so that a crash of a library is seen. A try is
identified by its number, from which `--first` makes the same file again. Ends with an error if any try
failed. One file, though long: a few lines for each reader.
"""

import argparse
import base64
import gzip
import json
import multiprocessing
import random
import resource
import struct
import sys
import tempfile
import time
import traceback
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.formats.reading import crowds
from nocturne_scene.formats.reading.crowds import MANY
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.placements import read_placements, write_placements
from nocturne_scene.photometry import eulumdat, far_field, files, ies, tm25, tm33
from nocturne_scene.photometry.intensities import BadPhotometryError, Photometry, flux
from nocturne_scene.photometry.tm25 import BadRayFileError, RayFile

from tests.pictures import write_exr
from tests.scene.formats.test_any_scene import CORPUS, WORDS, changed, try_import
from tests.scene.formats.test_gltf_shapes import Model, by_meshopt, draco_model

MEMORY_BYTES = 4 * 2**30
"""Of address space, with all libraries."""

_ACTS = ("replace", "remove", "copy", "swap")
_SHAPE = '<scene version="3.0.0">{}<emitter type="constant"/><shape type="{}">{}</shape></scene>'
_SENSOR = '<sensor type="perspective"><float name="fov" value="40"/></sensor>'
_FILE = '<string name="filename" value="{}"/>'
_OBJ = (
    b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 1\nvn 0 0 1\n"
    b"f 1/1/1 2/2/1 3/1/1\nf 1 2 4\nf 2// 3// 4//\n"
)
_CURVES = b"0 0 0 0.1\n1 0 0 0.1\n1 1 0 0.05\n1 1 1 0.1\n\n0 0 1 0.2\n0 1 1 0.2\n0 1 2 0.1\n0 2 2 0.1\n"


@dataclass(frozen=True)
class Seed:
    """A scene that is right, and the file of it that is made wrong."""

    scene: str
    part: str
    files: dict[str, bytes]
    """Beside those of the corpus."""
    words: bool = False
    """Whether words of the part are changed, not bytes."""

    def spoilt(self, random_: random.Random) -> bytes:
        """The part with some changes."""
        content = self.files.get(self.part) or (CORPUS / self.part).read_bytes()
        if self.words:
            acts = [
                (
                    random_.choice(_ACTS),
                    random_.randrange(10_000),
                    random_.randrange(10_000),
                    random_.randint(1, 30),
                    random_.choice(WORDS),
                )
                for _ in range(random_.randint(1, 5))
            ]
            return changed(content, acts)
        made = bytearray(content)
        # Headers are where most is decided.
        reach = random_.choice((64, 512, len(made)))
        for _ in range(random_.randint(1, 6)):
            at = random_.randrange(min(reach, len(made)))
            patch = random_.choice(
                (random_.randbytes(random_.randint(1, 6)), b"\xff" * 4, b"\0" * 4, b"\x7f")
            )
            made[at : at + len(patch)] = patch
        return bytes(made[: random_.randrange(len(made))] if random_.random() < 0.2 else made)


def _mitsuba(kind: str, name: str, content: bytes, inside: str = "", *, words: bool = False) -> Seed:
    scene = _SHAPE.format(_SENSOR, kind, inside or _FILE.format(name))
    return Seed("file.xml", name, {"file.xml": scene.encode(), name: content}, words)


def _serialized() -> bytes:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")
    numbers = struct.pack("<I", 0) + b"mesh\0" + struct.pack("<QQ", 3, 1)
    numbers += points.tobytes() + np.array([0, 1, 2], "<u4").tobytes()
    return struct.pack("<HH", 0x041C, 4) + zlib.compress(numbers) + struct.pack("<QI", 0, 1)


def _compressed(model: Model) -> list[Seed]:
    """Changes of the buffer's bytes, and of their description."""
    model.tree["buffers"] = [{"byteLength": len(model.content), "uri": "a.bin"}]
    if model.tree["bufferViews"][-1].get("buffer"):
        model.tree["buffers"].append({"byteLength": 10_000})
    files = {"file.gltf": json.dumps(model.tree).encode(), "a.bin": model.content}
    return [Seed("file.gltf", "a.bin", files), Seed("file.gltf", "file.gltf", files, words=True)]


def _glb() -> Seed:
    tree = json.loads((CORPUS / "scene.gltf").read_text())
    binary = base64.b64decode(tree["buffers"][0].pop("uri").partition(",")[2])
    text = json.dumps(tree).encode()
    text, binary = text + b" " * (-len(text) % 4), binary + b"\0" * (-len(binary) % 4)
    chunks = b"".join(
        struct.pack("<I4s", len(each), kind) + each for kind, each in ((b"JSON", text), (b"BIN\0", binary))
    )
    return Seed(
        "file.glb", "file.glb", {"file.glb": struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks}
    )


def _pictures(folder: Path) -> list[Seed]:
    values = np.random.default_rng(1).random((8, 8, 3)).astype(np.float32)
    write_exr(folder / "a.exr", values, "RGB")
    found = []
    for name in ("a.exr", "a.png", "a.hdr", "a.jpg", "a.tif"):
        oiio.ImageBuf(str(folder / "a.exr")).write(str(folder / name))
        texture = f'<texture name="reflectance" type="bitmap">{_FILE.format(name)}</texture>'
        inside = f'<bsdf type="diffuse">{texture}</bsdf>'
        found.append(_mitsuba("sphere", name, (folder / name).read_bytes(), inside))
    return found


def _archive(folder: Path) -> Seed:
    with zipfile.ZipFile(folder / "file.zip", "w", zipfile.ZIP_DEFLATED) as opened:
        for name in ("scene.xml", "a.ply", "a.vol", "c.vol"):
            opened.write(CORPUS / name, name)
    return Seed("file.zip", "file.zip", {"file.zip": (folder / "file.zip").read_bytes()})


def _words(scene: str) -> list[Seed]:
    return [Seed(scene, scene, {}, words=True)]


def _parts(_folder: Path) -> list[Seed]:
    return [
        Seed("scene.xml", "a.ply", {}),
        Seed("scene.pbrt", "a.ply", {}),
        Seed("scene.xml", "a.vol", {}),
        Seed("scene.xml", "c.vol", {}),
        _mitsuba("serialized", "a.serialized", _serialized()),
        _mitsuba("obj", "a.obj", _OBJ, words=True),
        _mitsuba("obj", "a.obj", _OBJ),
        _mitsuba("linearcurve", "a.txt", _CURVES, words=True),
        _mitsuba("bsplinecurve", "a.txt", _CURVES, words=True),
    ]


def _packed(folder: Path) -> list[Seed]:
    zipped = gzip.compress((CORPUS / "scene.pbrt").read_bytes(), mtime=0)
    return [
        _archive(folder),
        Seed("file.pbrt.gz", "file.pbrt.gz", {"file.pbrt.gz": zipped}),
        *_pictures(folder),
    ]


def _placements(folder: Path) -> list[Seed]:
    """No scene of others, but their placements are written so; as numbers, and as text."""
    rows = np.random.default_rng(1).uniform(0.1, 2.0, (20, 8))
    write_placements(folder / "rows.ply", rows)
    content = (folder / "rows.ply").read_bytes()
    head = content[: content.index(b"end_header\n") + 11].replace(b"binary_little_endian", b"ascii")
    lines = "".join(" ".join(map(str, row)) + "\n" for row in rows)
    texts = {"text.ply": head + lines.encode()}
    return [
        Seed("", "rows.ply", {"rows.ply": content}),
        Seed("", "text.ply", texts),
        Seed("", "text.ply", texts, words=True),
    ]


def _try_placements(file: Path, content: bytes) -> None:
    file.write_bytes(content)
    try:
        found = read_placements(file)
    except UnusableMeshError:
        return
    assert np.isfinite(found.shifts).all()
    assert (found.scales > 0).all()
    np.testing.assert_allclose(np.linalg.det(found.rotations), 1.0, rtol=1e-6)


def _luminaires(_: Path) -> list[Seed]:
    """Photometric files of each kind."""
    vertical, horizontal = np.array([0.0, 45.0, 90.0, 180.0]), np.array([0.0, 90.0, 180.0, 270.0, 360.0])
    candela = np.random.default_rng(1).uniform(1.0, 100.0, (5, 4))
    candela[-1] = candela[0]
    light = np.array([400.0, 500.0, 700.0]), np.array([0.5, 1.0, 0.2])
    lamp = Photometry(
        vertical, horizontal, candela, None, (0.1, 0.2, 0.0), 5.0, {"TEST": "1"}, spectrum=light
    )
    type_b = (
        b"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 3 2 2 0 0 0\n1 1 1\n-90 0 90\n-90 0 90\n1 2 3 4 5 6 7 8 9\n"
    )
    made = {
        "c.ies": ies.write(lamp),
        "b.ies": type_b,
        "a.ldt": eulumdat.write(lamp),
        "a.xml": tm33.write(lamp),
    }
    return [Seed("", name, {name: each}, words) for name, each in made.items() for words in (True, False)]


def _rays(folder: Path) -> list[Seed]:
    """A ray file with spectra and indices of them."""
    places, towards = np.zeros((4, 3), np.float32), np.array([[0, 0, 1]] * 4, np.float32)
    light = np.array([400.0, 700.0]), np.array([1.0, 0.5])
    index = np.array([0, 1, 0, 1], np.int32)
    tm25.write(
        folder / "a.rays", RayFile(places, towards, np.ones(4, np.float32), None, None, [light, light], index)
    )
    content = (folder / "a.rays").read_bytes()
    # The part that is spoilt has the numbers, and not the texts, which are most of it.
    return [Seed("", "a.rays", {"a.rays": content[:288] + content[36288:]})]


def _try_rays(file: Path, content: bytes) -> None:
    file.write_bytes(content[:288] + bytes(36000) + content[288:])
    try:
        found = tm25.read(file)
    except BadRayFileError:
        return
    assert np.isfinite(found.starts).all()
    candela, error = far_field.candela_of(found, 4, 3)
    assert np.isfinite(candela).all()
    assert np.isfinite(error).all()


def _try_luminaire(content: bytes) -> None:
    try:
        found = files.read(content)
    except BadPhotometryError:
        return
    assert np.isfinite(found.candela).all()
    assert (found.candela >= 0).all()
    assert found.candela.shape == (len(found.horizontal), len(found.vertical))
    assert flux(found) >= 0


READERS: dict[str, Callable[[Path], list[Seed]]] = {
    "mitsuba": lambda _: [*_words("scene.xml"), *_words("old.xml")],
    "pbrt": lambda _: [*_words("scene.pbrt"), *_words("old.pbrt")],
    "gltf": lambda _: _words("scene.gltf"),
    "gltf-binary": lambda _: [
        _glb(),
        *_compressed(draco_model()[0]),
        *_compressed(by_meshopt("EXT_meshopt_compression")),
    ],
    "parts": _parts,
    "packed": _packed,
    "placements": _placements,
    "luminaires": _luminaires,
    "rays": _rays,
}


@dataclass
class Tally:
    """The results of some tries."""

    tries: int = 0
    failed: int = 0
    slowest: float = 0.0
    megabytes: int = 0


def run(name: str, first: int, seconds: float) -> Tally:
    """Try a reader for so long; print what fails."""
    tally = Tally()
    ends = time.monotonic() + seconds
    context = multiprocessing.get_context("spawn")
    with tempfile.TemporaryDirectory() as kept:
        while time.monotonic() < ends:
            ours, theirs = context.Pipe(duplex=False)
            number = first + tally.tries
            process = context.Process(target=_work, args=(theirs, Path(kept), name, number, ends))
            process.start()
            theirs.close()
            try:
                while True:
                    error, tally.slowest, tally.megabytes = _worst(tally, ours.recv())
                    tally.tries += 1
                    if error:
                        tally.failed += 1
                        print(f"{name} {number}: {error}", flush=True)
                    number += 1
            except EOFError:
                process.join()
                if process.exitcode:
                    tally.tries += 1
                    tally.failed += 1
                    print(f"{name} {number}: ended with status {process.exitcode}", flush=True)
    return tally


def _worst(tally: Tally, told: tuple[str, float, int]) -> tuple[str, float, int]:
    error, seconds, megabytes = told
    return error, max(tally.slowest, seconds), max(tally.megabytes, megabytes)


def _work(sender: Connection, folder: Path, name: str, first: int, ends: float) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    seeds = READERS[name](folder)
    number = first
    # The clock is the same in all processes.
    while time.monotonic() < ends:
        random_ = random.Random(number)
        seed = random_.choice(seeds)
        # In every other try, repeated shapes share files already.
        crowds.MANY = (MANY, 1)[number % 2]
        started = time.process_time()
        error = ""
        try:
            contents = {**seed.files, seed.part: seed.spoilt(random_)}
            if name == "placements":
                _try_placements(folder / "spoilt.ply", contents[seed.part])
            elif name == "luminaires":
                _try_luminaire(contents[seed.part])
            elif name == "rays":
                _try_rays(folder / "spoilt.rays", contents[seed.part])
            else:
                try_import(seed.scene, contents, allow_missing=random_.random() < 0.5)
        except BaseException:  # whatever it is, it is told
            error = f"{seed.part}: {traceback.format_exc()}"
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        sender.send((error, time.process_time() - started, peak))
        number += 1


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m tests.scene.formats.fuzz")
    parser.add_argument(
        "readers", nargs="*", metavar="READER", help=f"Of {', '.join(READERS)}; default: all."
    )
    parser.add_argument("--seconds", type=float, default=600.0, help="For each reader.")
    parser.add_argument("--first", type=int, default=0, help="The number of the first try.")
    arguments = parser.parse_args()
    failed = 0
    for name in arguments.readers or READERS:
        tally = run(name, arguments.first, arguments.seconds)
        print(
            f"{name}: {tally.tries} files from number {arguments.first}, {tally.failed} failed, "
            f"slowest {tally.slowest:.1f} s of CPU, at most {tally.megabytes} MB",
            flush=True,
        )
        failed += tally.failed
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
