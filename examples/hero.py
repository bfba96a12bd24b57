"""The README's first picture: a meeting room, its right third as illuminance, its table measured.

python -m examples.hero                 # two renders with other seeds are shown as their mean
python -m examples.hero --kept FOLDER   # draws only, from images that --into left there

It writes docs/images/hero.webp and docs/images/hero.json, whose figures stand under the picture.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne.v1 import job_pb2
from nocturne_client.local.false_colour import COLOURS, ink_on
from nocturne_scene.compare.images import read_picture
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from examples.gallery import (
    EXAMPLES,
    MAX_PICTURE_BYTES,
    THREADS,
    Cost,
    cpu_seconds,
    keep,
    measured_error,
    pictures,
    shown,
    stated_error,
    write_webp,
)
from examples.meeting_room import make_room

PICTURE = EXAMPLES.parent / "docs" / "images" / "hero.webp"
FIGURES = PICTURE.with_suffix(".json")
STEPS = (10, 20, 40, 70, 100, 200, 300, 500, 750)
"""lx, between the colours."""

LAMP = (0.4053, 0.3907)
"""Chromaticity of the luminaire's 3500 K, which is shown as white."""

CONFIDENCE = 1.96
"""Standard errors in half of a 95 % interval."""

_DARK = 0.02
"""Surfaces that reflect less have no illuminance that could be read from their luminance."""

Values = NDArray[np.float64]


def main() -> None:
    """Render, unless images are kept, and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--width", type=int, default=1600, help="pixels; the height is nine sixteenths of it")
    parser.add_argument("--samples", type=int, default=2000, help="per pixel, of both renders together")
    parser.add_argument("--kept", type=Path, help="a folder that --into filled")
    parser.add_argument("--into", type=Path, help="keep the images here")
    arguments = parser.parse_args()
    if arguments.kept:
        draw(arguments.kept)
        return
    with tempfile.TemporaryDirectory(prefix="nocturne-hero-") as name:
        folder = arguments.into or Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        render(folder, arguments.width, arguments.samples)
        draw(folder)


def render(folder: Path, width: int, samples: int) -> None:
    """Two images of the room, and what the meters on the table read, into a folder."""
    before = cpu_seconds()
    make_room.main(folder)
    threads = ["--threads", os.environ.get(THREADS, "0")]
    for seed in ("1", "2"):
        film = ["--width", str(width), "--height", str(width * 9 // 16), "--samples", str(samples // 2)]
        layers = ["--layers", "albedo,emission", "--seed", seed]
        _nocturne("render", folder / "view.json", "-o", folder / f"view-{seed}.exr", *film, *layers, *threads)
    _nocturne("render", folder / "table.json", "-o", folder / "table.exr", "--samples", "4096", *threads)
    read = _nocturne("measure", folder / "table.exr", "--json")
    (folder / "read.json").write_text(read)
    run = {"samples": samples, "engine": int(job_pb2.ENGINE_CURRENT), "cpu_seconds": cpu_seconds() - before}
    (folder / "run.json").write_text(json.dumps(run))


def _nocturne(*words: str | Path) -> str:
    ran = subprocess.run(  # noqa: S603
        [sys.executable, "-m", "nocturne_client", *words], check=True, capture_output=True, text=True
    )
    return ran.stdout


def draw(folder: Path) -> None:
    """The picture and its figures."""
    read = [read_picture(folder / f"view-{seed}.exr") for seed in (1, 2)]
    images = np.stack([each.xyz for each in read])
    xyz = images.mean(axis=0)
    left = shown(xyz, 0.0, LAMP)
    lux, known = illuminance(xyz[..., 1], *_layers(folder / "view-1.exr"))
    right = np.where(known[..., None], false_colour(lux), left // 2)
    height, width = lux.shape
    edge = 2 * width // 3
    picture = Image.fromarray(np.concatenate([left[:, :edge], right[:, edge:].astype(np.uint8)], axis=1))
    reading, run = table_reading(folder), json.loads((folder / "run.json").read_text())
    label = f"table: {reading['mean']:.0f} ± {CONFIDENCE * reading['error']:.1f} lx (95 %)"
    _annotate(picture, edge, _place_of_table(width, height), label)
    write_webp(PICTURE, np.asarray(picture), 400_000)
    measured = measured_error(images[..., 1])
    figures = {"label": label, "width": width, "height": height, **run, "measured_error": measured}
    FIGURES.write_text(json.dumps(figures, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    # The whole room is a picture of the gallery, too.
    entry = next(each for each in pictures() if each.scene == "meeting_room/view.json")
    write_webp(EXAMPLES / entry.file, left, MAX_PICTURE_BYTES[entry.is_large])
    seconds = run["cpu_seconds"]
    cost = Cost(
        width,
        height,
        run["samples"],
        None if seconds is None else round(seconds, 1),
        stated_error(read),
        run["engine"],
        measured,
    )
    keep(entry, cost)


def illuminance(luminance: Values, albedo: Values, emission: Values) -> tuple[Values, NDArray[np.bool_]]:
    """lx on surfaces that reflect diffusely, E = pi L / albedo, and where that holds: on no lamp, nor in the
    sky."""
    known = (albedo > _DARK) & (emission <= 0.0)
    lux: Values = np.pi * luminance / np.where(known, albedo, 1.0)
    return lux, known


def _layers(image: Path) -> tuple[Values, Values]:
    """Albedo (luminance of its linear sRGB), and which part of a pixel emits."""
    buffer = oiio.ImageBuf(str(image))
    names = list(buffer.spec().channelnames)
    values = np.asarray(buffer.get_pixels(oiio.FLOAT), dtype=np.float64)
    red, green, blue, emission = (
        values[..., names.index(each)] for each in ("albedo.R", "albedo.G", "albedo.B", "emission.part")
    )
    # Luminance of linear sRGB, ITU-R BT.709.
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue, emission


def false_colour(lux: Values) -> NDArray[np.uint8]:
    """The colours of reports, by steps."""
    colours = np.array([[int(each[at : at + 2], 16) for at in (1, 3, 5)] for each in COLOURS], dtype=np.uint8)
    found: NDArray[np.uint8] = colours[np.searchsorted(STEPS, lux, side="right")]
    return found


def table_reading(folder: Path) -> dict[str, Any]:
    """Mean illuminance of the table and its standard error, lx."""
    read = json.loads((folder / "read.json").read_text())
    part = next(each for each in read["measurements"] if each["outline"]["name"] == "table")
    return {"mean": part["mean"], "error": part["mean_error"]}


def _place_of_table(width: int, height: int) -> tuple[float, float]:
    """The pixel of a point on the table."""
    sensor = json.loads((EXAMPLES / "meeting_room" / "view.json").read_text())["sensor"]
    eye, at = (np.array(sensor[key]) for key in ("position", "look_at"))
    ahead = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(ahead, (0, 1, 0))
    right /= np.linalg.norm(right)
    left, far_right, far, near, top = make_room.TABLE
    to = np.array([0.45 * left + 0.55 * far_right, top, 0.4 * far + 0.6 * near]) - eye
    x, y, z = to @ right, to @ np.cross(right, ahead), to @ ahead
    scale = 0.5 * height / np.tan(np.deg2rad(0.5 * sensor["vertical_field_of_view_degrees"]))
    return 0.5 * width + scale * x / z, 0.5 * height - scale * y / z


def _annotate(picture: Image.Image, edge: int, table: tuple[float, float], label: str) -> None:
    """The border of the two halves, the table's label, and the key of the colours."""
    width, height = picture.size
    pen, size = ImageDraw.Draw(picture), height // 34
    font = ImageFont.load_default(size)
    pen.line([(edge, 0), (edge, height)], fill="white", width=max(1, height // 450))
    x, y = table
    corner = (int(x - 0.30 * width), int(y + 0.17 * height))
    box = pen.textbbox(corner, label, font=font)
    box = (box[0] - size // 2, box[1] - size // 2, box[2] + size // 2, box[3] + size // 2)
    pen.line([(x, y), (box[2], box[1])], fill="white", width=max(1, height // 450))
    pen.ellipse([x - size / 4, y - size / 4, x + size / 4, y + size / 4], fill="white")
    pen.rectangle(box, fill="white")
    pen.text(corner, label, font=font, fill="black")
    wide, tall = 4 * size, int(1.5 * size)
    bottom = height - size - len(COLOURS) * tall
    for index, colour in enumerate(reversed(COLOURS)):
        top = bottom + index * tall
        left = width - size - wide
        pen.rectangle([left, top, left + wide, top + tall], fill=colour)
        if index < len(STEPS):
            text = f"{STEPS[len(STEPS) - 1 - index]}" + (" lx" if index == 0 else "")
            pen.text((left + size // 4, top + size // 5), text, font=font, fill=ink_on(colour))


if __name__ == "__main__":
    main()
