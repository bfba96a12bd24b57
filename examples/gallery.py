"""The gallery: renders the examples, keeps a picture of each next to it, and writes docs/gallery.md.

python -m examples.gallery                          # pictures whose film or samples in the table are new
python -m examples.gallery FOLDER ...               # those of some folders, anyway
python -m examples.gallery --samples 4 --into DIR   # drafts, to look at; nothing in the repository changes
python -m examples.gallery --page                   # the page alone, from kept figures
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_client.preview.colour import linear_srgb
from nocturne_coordinator.output.images import tone_map
from numpy.typing import NDArray

from bench.machine import processor

EXAMPLES = Path(__file__).parent
PAGE = EXAMPLES.parent / "docs" / "gallery.md"
TABLE = EXAMPLES / "gallery.toml"
FIGURES = EXAMPLES / "gallery.json"

MAX_PICTURE_BYTES = 150_000
"""Of each picture, so that the repository stays small."""

_QUALITIES = (90, 80, 70, 60, 50)


@dataclass(frozen=True)
class Picture:
    """What to render."""

    scene: str
    """Below the folder of examples: a scene document, or a scene of pbrt's."""
    width: int
    height: int
    samples: int
    tracing: dict[str, Any] = field(default_factory=dict)
    """Replaces options of the document's `tracing`."""
    sensor: dict[str, Any] = field(default_factory=dict)
    """Replaces properties of the document's `sensor`, where a picture shows more or less than tests see."""
    white: float = 0.0
    """Luminance in cd/m2 that is shown as white, without tone mapping; 0: as the service shows it."""

    @property
    def document(self) -> Path:
        return EXAMPLES / self.scene

    @property
    def folder(self) -> str:
        return self.document.parent.name

    @property
    def file(self) -> str:
        """Where the picture is, below the folder of examples."""
        stem = self.document.stem
        return f"{self.folder}/{'picture' if stem == 'scene' else stem}.webp"


@dataclass(frozen=True)
class Cost:
    """What a picture took."""

    width: int
    height: int
    samples: int
    cpu_seconds: float
    relative_error: float | None
    """Root mean square over pixels of Y's standard error relative to Y; None where nothing was seen."""


def pictures() -> list[Picture]:
    """All of the table, in its order."""
    return [Picture(**each) for each in tomllib.loads(TABLE.read_text(encoding="utf-8"))["picture"]]


def main() -> None:
    """Render the named examples; then write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folders", nargs="*", help="folders of examples; default: outdated ones")
    parser.add_argument("--samples", type=int, help="instead of those of the table")
    parser.add_argument("--into", type=Path, help="where pictures go instead of the examples' folders")
    parser.add_argument("--page", action="store_true", help="only write the page")
    arguments = parser.parse_args()
    named = arguments.folders
    wanted = [each for each in pictures() if (each.folder in named if named else not _is_kept(each))]
    for picture in [] if arguments.page else wanted:
        file = (arguments.into or EXAMPLES) / picture.file
        cost = render(picture, file, arguments.samples or picture.samples)
        print(picture.scene, json.dumps(asdict(cost)), f"{file.stat().st_size} bytes", flush=True)
        if arguments.into is None:
            _keep(picture, cost)
    if arguments.into is None:
        PAGE.write_text(page(), encoding="utf-8")


def render(picture: Picture, file: Path, samples: int) -> Cost:
    """Render a picture into a WebP file."""
    make_files(picture.document.parent)
    with tempfile.TemporaryDirectory(prefix="nocturne-gallery-") as name:
        folder = Path(name)
        document = _document(picture, folder)
        image = folder / "image.exr"
        size = ["--width", str(picture.width), "--height", str(picture.height), "--samples", str(samples)]
        before = _cpu_seconds()
        try:
            _nocturne("render", document, "-o", image, *size)
        finally:
            if document.name.startswith(".gallery-"):
                document.unlink()
        seconds = _cpu_seconds() - before
        channels = _read(image)
        _write(file, _shown(channels[..., :3], picture.white))
    return Cost(picture.width, picture.height, samples, round(seconds, 1), _relative_error(channels))


def make_files(folder: Path) -> None:
    """Run the example's own program, if it has one: equal programs write equal files."""
    for program in folder.glob("make_*.py"):
        if not any(folder.glob("*.ply")) and not any(folder.glob("*.exr")) and not any(folder.glob("*.vdb")):
            subprocess.run([sys.executable, program, folder], check=True)  # noqa: S603


def _document(picture: Picture, folder: Path) -> Path:
    """The scene document to render: the example's, or one next to it with another method or view."""
    if picture.document.suffix != ".json":
        _nocturne("import", picture.document, "-o", folder / "scene")
        return folder / "scene" / "scene.json"
    if not (picture.tracing or picture.sensor):
        return picture.document
    document = json.loads(picture.document.read_text(encoding="utf-8"))
    document["tracing"] = {**document.get("tracing", {}), **picture.tracing}
    document["sensor"] = {**document["sensor"], **picture.sensor}
    # Beside the original, for the files that it names.
    changed = picture.document.with_name(f".gallery-{picture.document.name}")
    changed.write_text(json.dumps(document), encoding="utf-8")
    return changed


def _nocturne(*words: str | Path) -> None:
    subprocess.run([sys.executable, "-m", "nocturne_client", *words], check=True, capture_output=True)  # noqa: S603


def _cpu_seconds() -> float:
    """Of all children that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _read(image: Path) -> NDArray[np.float64]:
    """X, Y, Z and the standard error of Y, shape (height, width, 4)."""
    buffer = oiio.ImageBuf(str(image))
    names = buffer.spec().channelnames
    values = np.asarray(buffer.get_pixels(oiio.FLOAT), dtype=np.float64)
    return values[..., [names.index(name) for name in ("X", "Y", "Z", "Y.stderr")]]


def _relative_error(channels: NDArray[np.float64]) -> float | None:
    """As docs/glossary.md defines it."""
    y, error = channels[..., 1], channels[..., 3]
    mean = float(y.mean())
    if mean <= 0:
        return None
    return float(np.sqrt(np.mean(error**2 / (y**2 + 0.01 * mean**2))))


def _shown(xyz: NDArray[np.float64], white: float) -> NDArray[np.uint8]:
    """sRGB (IEC 61966-2-1): tone-mapped by the service's own function, or linear up to a white."""
    if white == 0.0:
        return tone_map(xyz, np.ones(xyz.shape[:2], dtype=np.uint32))
    linear = np.clip(linear_srgb((xyz / white).astype(np.float32)), 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.rint(255.0 * encoded).astype(np.uint8)


def _write(file: Path, pixels: NDArray[np.uint8]) -> None:
    """As WebP, of the best quality that is small enough."""
    file.parent.mkdir(parents=True, exist_ok=True)
    for quality in _QUALITIES:
        spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8")
        spec.attribute("compression", f"webp:{quality}")
        buffer = oiio.ImageBuf(spec)
        buffer.set_pixels(oiio.ROI(), pixels)
        if not buffer.write(str(file)):
            raise OSError(f"{file}: {buffer.geterror()}")
        if file.stat().st_size <= MAX_PICTURE_BYTES:
            return
    raise ValueError(f"{file} is larger than {MAX_PICTURE_BYTES} bytes; more samples make it smaller")


def _kept() -> dict[str, Any]:
    """Figures of pictures that were rendered, and on which machine."""
    found: dict[str, Any] = {"machine": processor(), "pictures": {}}
    if FIGURES.exists():
        found.update(json.loads(FIGURES.read_text(encoding="utf-8")))
    return found


def _is_kept(picture: Picture) -> bool:
    """Whether the picture that is there is what the table asks for."""
    kept = _kept()["pictures"].get(picture.scene, {})
    asked = (picture.width, picture.height, picture.samples)
    return asked == (kept.get("width"), kept.get("height"), kept.get("samples"))


def _keep(picture: Picture, cost: Cost) -> None:
    kept = _kept()
    kept["machine"] = processor()
    kept["pictures"][picture.scene] = asdict(cost)
    FIGURES.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", encoding="utf-8")


_PAGE_HEAD = """# Gallery

<!-- Made by `make gallery`; edit examples/gallery.toml and the examples' own pages, not this page. -->

Every example with its picture, description and cost. The pictures are tone-mapped (Reinhard 2002);
absolute values are in the images that `nocturne render` writes. *Samples* are per pixel, *CPU time* is that
of the whole command, compiling included, on {machine}, and *error* is the [relative
error](glossary.md#images-and-their-errors) as the image itself estimates it.

"""

# The examples' own pages, for the site's list of pages.
_PAGE_END = """```{toctree}
:hidden:
:glob:

/examples/*/README
```
"""


def page() -> str:
    """docs/gallery.md, from the examples' own pages and kept figures."""
    figures = _kept()
    table = pictures()
    sections = [
        _section(folder, [each for each in table if each.folder == folder], figures["pictures"])
        for folder in dict.fromkeys(each.folder for each in table)
    ]
    return "\n".join([_PAGE_HEAD.format(machine=figures["machine"]), *sections, _PAGE_END])


def _section(folder: str, table: list[Picture], figures: dict[str, Any]) -> str:
    """One example: its name, its pictures, the first paragraph of its page, and costs."""
    title, about = (EXAMPLES / folder / "README.md").read_text(encoding="utf-8").split("\n\n")[:2]
    name = title.removeprefix("# ")
    lines = [f"## {name}", "", about, ""]
    for picture in table:
        lines += [f"![{name}](../examples/{picture.file})", ""]
    lines += ["| scene | film | samples | CPU time | error |", "| --- | --- | --- | --- | --- |"]
    lines += [_row(picture, figures[picture.scene]) for picture in table]
    lines += ["", f"Files and commands: [examples/{folder}](../examples/{folder}/README.md)", ""]
    return "\n".join(lines)


def _row(picture: Picture, cost: dict[str, Any]) -> str:
    error = cost["relative_error"]
    told = "nothing seen" if error is None else f"{100 * error:.2g} %"
    film = f"{cost['width']} x {cost['height']}"
    changed = {**picture.tracing, **picture.sensor}
    way = "".join(f", {name.replace('_', ' ')} {value}" for name, value in changed.items())
    return f"| `{picture.scene}`{way} | {film} | {cost['samples']:,} | {cost['cpu_seconds']:.0f} s | {told} |"


if __name__ == "__main__":
    main()
