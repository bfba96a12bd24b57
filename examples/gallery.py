"""The gallery: renders the examples, keeps a picture of each next to it, and writes docs/gallery.md.

python -m examples.gallery                          # pictures whose film or samples in the table are new
python -m examples.gallery FOLDER ...               # those of some folders, anyway
python -m examples.gallery moon/scene.json ...      # these, anyway
python -m examples.gallery --samples 4 --into DIR   # drafts, to look at; nothing in the repository changes
python -m examples.gallery --page                   # the page alone, from kept figures

Long: the table, renders, figures and the page are one thing, of which nothing is used elsewhere.
"""

import argparse
import json
import os
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
from nocturne.v1 import job_pb2
from nocturne_client.preview.colour import linear_srgb
from nocturne_coordinator.output.images import tone_map
from nocturne_scene.compare.images import Picture as Image
from nocturne_scene.compare.images import read_picture
from numpy.typing import NDArray

from bench.machine import processor

EXAMPLES = Path(__file__).parent
PAGE = EXAMPLES.parent / "docs" / "gallery.md"
TABLE = EXAMPLES / "gallery.toml"
FIGURES = EXAMPLES / "gallery.json"

MAX_PICTURE_BYTES = {False: 150_000, True: 500_000}
"""Of each picture, small and large, so that the repository stays small."""

LARGE = (1600, 900)
"""Pixels at least: such pictures open the page."""

THREADS = "NOCTURNE_GALLERY_THREADS"
"""Environment variable: how many threads trace. Default: one for each processor."""

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
    adapted: tuple[float, float] = (0.3127, 0.3290)
    """Chromaticity x, y of the light that is shown as white; that of D65 changes nothing."""
    seeds: int = 1
    """Renders whose mean is shown, each of another seed. Two and more measure the error by their spread."""
    title: str = ""
    """Of a large picture."""
    caption: str = ""
    """What a large picture shows."""

    @property
    def is_large(self) -> bool:
        return self.width >= LARGE[0] and self.height >= LARGE[1]

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
    """Per pixel, in all renders together."""
    cpu_seconds: float | None
    """None where they were not kept."""
    relative_error: float | None
    """As the images themselves estimate it, for their mean; None where nothing was seen."""
    engine: int
    """That traced it."""
    measured_error: float | None = None
    """The relative error by the spread of renders with other seeds, where there are any."""


def pictures() -> list[Picture]:
    """All of the table, in its order."""
    entries = tomllib.loads(TABLE.read_text(encoding="utf-8"))["picture"]
    return [Picture(**{**each, "adapted": tuple(each.get("adapted", Picture.adapted))}) for each in entries]


def main() -> None:
    """Render the named examples; then write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folders", nargs="*", help="folders of examples; default: outdated ones")
    parser.add_argument("--samples", type=int, help="instead of those of the table")
    parser.add_argument("--into", type=Path, help="where pictures go instead of the examples' folders")
    parser.add_argument("--page", action="store_true", help="only write the page")
    arguments = parser.parse_args()
    named = arguments.folders
    wanted = [
        each for each in pictures() if ({each.folder, each.scene} & {*named} if named else not _is_kept(each))
    ]
    for picture in [] if arguments.page else wanted:
        file = (arguments.into or EXAMPLES) / picture.file
        cost = render(picture, file, arguments.samples or picture.samples)
        print(picture.scene, json.dumps(asdict(cost)), f"{file.stat().st_size} bytes", flush=True)
        if arguments.into is None:
            keep(picture, cost)
    if arguments.into is None:
        PAGE.write_text(page(), encoding="utf-8")


def render(picture: Picture, file: Path, samples: int) -> Cost:
    """Render a picture into a WebP file."""
    make_files(picture.document.parent)
    with tempfile.TemporaryDirectory(prefix="nocturne-gallery-") as name:
        folder = Path(name)
        document = _document(picture, folder)
        size = ["--width", str(picture.width), "--height", str(picture.height)]
        size += ["--samples", str(samples // picture.seeds), "--threads", os.environ.get(THREADS, "0")]
        before = cpu_seconds()
        images = []
        try:
            for seed in range(picture.seeds):
                image = folder / f"{seed}.exr"
                seeds = ["--seed", str(seed + 1)] if picture.seeds > 1 else []
                _nocturne("render", document, "-o", image, *size, *seeds)
                images.append(read_picture(image))
        finally:
            if document.name.startswith(".gallery-"):
                document.unlink()
        seconds = cpu_seconds() - before
        values = np.stack([each.xyz for each in images])
        most = MAX_PICTURE_BYTES[picture.is_large]
        write_webp(file, shown(values.mean(axis=0), picture.white, picture.adapted), most)
    return Cost(
        picture.width,
        picture.height,
        samples,
        round(seconds, 1),
        stated_error(images),
        int(job_pb2.ENGINE_CURRENT),
        measured_error(values[..., 1]) if picture.seeds > 1 else None,
    )


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


def cpu_seconds() -> float:
    """Of all children that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def stated_error(images: list[Image]) -> float | None:
    """Of the mean of images, as docs/glossary.md defines it; each image's own estimate."""
    mean = np.mean([each.xyz[..., 1] for each in images], axis=0)
    moments = [each.moments for each in images if each.moments is not None]
    if float(mean.mean()) <= 0 or not moments:
        return None
    variance = np.sum([each.variance[..., 1] for each in moments], axis=0) / len(images) ** 2
    return float(np.sqrt(np.mean(variance / _level(mean))))


def measured_error(values: NDArray[np.float64]) -> float:
    """The relative error of the mean of renders with other seeds, by the spread of these.

    `values` is Y, of shape (renders, height, width). The estimate's own spread is small: each pixel has a
    degree of freedom for each render but one.
    """
    mean = values.mean(axis=0)
    variance = values.var(axis=0, ddof=1) / len(values)
    return float(np.sqrt(np.mean(variance / _level(mean))))


def _level(mean: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the variance is relative to: the second term keeps black pixels from dominating."""
    level: NDArray[np.float64] = mean**2 + 0.01 * mean.mean() ** 2
    return level


def shown(xyz: NDArray[np.float64], white: float, adapted: tuple[float, float]) -> NDArray[np.uint8]:
    """sRGB (IEC 61966-2-1): tone-mapped by the service's own function, or linear up to a white."""
    xyz = xyz @ adaptation(adapted).T
    if white == 0.0:
        return tone_map(xyz, np.ones(xyz.shape[:2], dtype=np.uint32))
    linear = np.clip(linear_srgb((xyz / white).astype(np.float32)), 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.rint(255.0 * encoded).astype(np.uint8)


def adaptation(light: tuple[float, float]) -> NDArray[np.float64]:
    """Takes XYZ under a light of chromaticity x, y to what looks the same under D65.

    Von Kries with the cone responses of Bradford (Lam 1985), as ICC profiles have it.
    """
    cones = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
    there, here = (cones @ np.array([x / y, 1.0, (1 - x - y) / y]) for x, y in (light, (0.3127, 0.3290)))
    found: NDArray[np.float64] = np.linalg.inv(cones) @ np.diag(here / there) @ cones
    return found


def write_webp(file: Path, pixels: NDArray[np.uint8], most: int) -> None:
    """As WebP, of the best quality that is no more than so many bytes."""
    file.parent.mkdir(parents=True, exist_ok=True)
    for quality in _QUALITIES:
        spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8")
        spec.attribute("compression", f"webp:{quality}")
        buffer = oiio.ImageBuf(spec)
        buffer.set_pixels(oiio.ROI(), pixels)
        if not buffer.write(str(file)):
            raise OSError(f"{file}: {buffer.geterror()}")
        if file.stat().st_size <= most:
            return
    raise ValueError(f"{file} is larger than {most} bytes; more samples make it smaller")


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


def keep(picture: Picture, cost: Cost) -> None:
    kept = _kept()
    kept["machine"] = processor()
    kept["pictures"][picture.scene] = asdict(cost)
    FIGURES.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", encoding="utf-8")


_PAGE_HEAD = """# Gallery

<!-- Made by `make gallery`; edit examples/gallery.toml and the examples' own pages, not this page. -->

The [relative error](glossary.md#images-and-their-errors) is that of a typical pixel. Under large pictures
it is *measured*: two renders with other seeds are shown as their mean, and their spread is the error. The
images' own estimate stands behind it; it is larger, as it does not know how evenly the samples are spread.
CPU time is that of the whole command on {machine}. Values in cd/m2 are in the images that `nocturne render`
writes.

"""

_SMALL_HEAD = """## Small examples

Tone-mapped (Reinhard 2002). Samples are per pixel; errors are the images' own estimates. {older}
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
    table = [each for each in pictures() if each.scene in figures["pictures"]]
    large = [each for each in table if each.is_large]
    small = [each for each in table if not each.is_large]
    sections = [_large_section(each, figures["pictures"][each.scene]) for each in large]
    older = sorted({figures["pictures"][each.scene]["engine"] for each in small} - {_newest(figures)})
    numbers = ", ".join(f"{each}" for each in older)
    said = f"Pictures by older engines ({numbers}) show more noise than today's." if older else ""
    sections.append(_SMALL_HEAD.format(older=said))
    sections += [
        _section(folder, [each for each in small if each.folder == folder], figures["pictures"])
        for folder in dict.fromkeys(each.folder for each in small)
    ]
    return "\n".join([_PAGE_HEAD.format(machine=figures["machine"]), *sections, _PAGE_END])


def _newest(figures: dict[str, Any]) -> int:
    return max(int(each["engine"]) for each in figures["pictures"].values())


def _large_section(picture: Picture, cost: dict[str, Any]) -> str:
    """A large picture with its caption."""
    folder = picture.folder
    figures = f"Relative error {_told(cost['measured_error'])} (own estimate {_told(cost['relative_error'])})"
    film = f"{cost['width']} x {cost['height']}, {cost['samples']:,} samples per pixel"
    files = f"[examples/{folder}](../examples/{folder}/README.md)"
    cpu = f"{_time(cost)}, engine {cost['engine']}"
    what = f"*{picture.caption} {figures}; {film}, {cpu}. {files}*"
    return "\n".join(
        [f"## {picture.title}", "", f"![{picture.title}](../examples/{picture.file})", "", what, ""]
    )


def _section(folder: str, table: list[Picture], figures: dict[str, Any]) -> str:
    """One example: its name, its pictures, the first paragraph of its page, and costs."""
    title, about = (EXAMPLES / folder / "README.md").read_text(encoding="utf-8").split("\n\n")[:2]
    name = title.removeprefix("# ")
    lines = [f"### {name}", "", f"{about} [Files](../examples/{folder}/README.md)", ""]
    for picture in table:
        lines += [f"![{name}, {picture.document.stem}](../examples/{picture.file})", ""]
    lines += [
        "| scene | film | samples | time | error | engine |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    lines += [_row(picture, figures[picture.scene]) for picture in table]
    return "\n".join([*lines, ""])


def _row(picture: Picture, cost: dict[str, Any]) -> str:
    film = f"{cost['width']} x {cost['height']}"
    changed = {**picture.tracing, **picture.sensor}
    how = "".join(f", {name.replace('_', ' ')} {value}" for name, value in changed.items())
    measured = cost["measured_error"]
    error = _told(cost["relative_error"]) if measured is None else f"{_told(measured)}, measured"
    took = f"{_time(cost)} | {error} | {cost['engine']}"
    return f"| `{picture.scene}`{how} | {film} | {cost['samples']:,} | {took} |"


def _time(cost: dict[str, Any]) -> str:
    seconds = cost["cpu_seconds"]
    return "time not kept" if seconds is None else f"{seconds:.0f} CPU s"


def _told(error: float | None) -> str:
    return "nothing seen" if error is None else f"{100 * error:.2g} %"


if __name__ == "__main__":
    main()
