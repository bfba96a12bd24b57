"""Gains and losses of pixels that reuse their neighbours' paths, compared with pixels alone.

The bench measures the error for the same time, whether the blocks' squares show in the error (a line in its
power spectrum), and whether pixels at the edge of a tile, where blocks are cut off, are worse than others. It
makes the pictures of docs/explanation/sharing.md at equal processor time.
"""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO
from nocturne_client.local.programs import CHECKOUT
from nocturne_scene.ranges import TILE_SIZE

from bench.errors import true_relmse
from bench.peer.agreement import Reference
from bench.peer.contenders import FilmSize, Frame, Ours
from bench.peer.scenes import Scene, scenes
from bench.programs import Channel
from bench.report import Figures, Row, significant
from bench.scenes import compile_film

SCENES = ("cornell", "room")
WAYS = {"alone": 1, "4 x 4": 16}
PICTURES = CHECKOUT / "docs" / "images" / "sharing"

_THREADS = 2
_REFERENCE_SEED = 5000
_BLOCK = 4
_NEAR = 2
"""Lines of the spectrum on each side that a line is compared with."""
_ENLARGED = 2


@dataclass(frozen=True)
class _Size:
    shrink: int
    samples: int
    rounds: int
    reference_frames: int
    reference_samples: int


_FULL, _QUICK = _Size(1, 64, 8, 6, 512), _Size(4, 16, 2, 2, 32)


def run(quick: bool) -> Figures:
    """All methods on all scenes, seeds in turns."""
    size = _QUICK if quick else _FULL
    return {name: _scene(name, scenes()[name], size, draw=not quick) for name in SCENES}


def rows(figures: Figures) -> list[Row]:
    """Each method against pixels alone."""
    table = []
    for name in SCENES:
        for way in list(WAYS)[1:]:
            found = figures[name][way]
            table += [
                Row(f"{name}, {way}: efficiency / alone", f"{found['efficiency']:.3g}"),
                Row(
                    f"{name}, {way}: largest line of the error's spectrum at blocks' frequencies / near it",
                    f"{found['line']:.3g} (alone {figures[name]['alone']['line']:.3g})",
                    "at most 2",
                ),
                Row(
                    f"{name}, {way}: relMSE at tiles' edges / within, over that alone",
                    f"{found['edge'] / figures[name]['alone']['edge']:.3g}",
                ),
            ]
    return table


def _scene(name: str, scene: Scene, size: _Size, draw: bool) -> Figures:
    film = FilmSize(scene.width // size.shrink, scene.height // size.shrink)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        document = scene.write(Path(folder))
        ours = {}
        for way, sharing in WAYS.items():
            document["tracing"] = {**document.get("tracing", {}), "direction": "adjoint", "sharing": sharing}
            into = Path(folder) / way
            compiled = compile_film(document, Path(folder), film.width, film.height, size.samples, into)
            ours[way] = Ours(compiled, film, _THREADS)
        frames: dict[str, list[Frame]] = {way: [] for way in WAYS}
        for seed in range(size.rounds):
            for way in WAYS:
                frames[way].append(ours[way].frame(size.samples, seed))
        shared = list(WAYS)[-1]
        reference = Reference.of(
            [
                ours[shared].frame(size.reference_samples, _REFERENCE_SEED + i).y
                for i in range(size.reference_frames)
            ]
        )
        if draw:
            costs = {way: _cpu_s(frames[way]) for way in WAYS}
            as_long = round(size.samples * costs[shared] / costs["alone"])
            _write(f"{name}-alone", ours["alone"].frame(as_long, 0).y, reference.y)
            _write(f"{name}-shared", frames[shared][0].y, reference.y)
            _write(f"{name}-reference", reference.y, reference.y)
    found = {way: _figures(frames[way], reference) for way in WAYS}
    alone = found["alone"]["efficiency"]
    for each in found.values():
        each["efficiency"] = significant(each["efficiency"] / alone)
    return found


def _cpu_s(frames: list[Frame]) -> float:
    return float(np.median([frame.cpu_s for frame in frames]))


def _figures(frames: list[Frame], reference: Reference) -> Figures:
    relmse = float(np.mean([true_relmse(frame.y, reference.y, reference.error) for frame in frames]))
    cpu_s = _cpu_s(frames)
    errors = [
        (frame.y - reference.y) / np.sqrt(reference.y**2 + 0.01 * reference.y.mean() ** 2) for frame in frames
    ]
    return {
        "relmse": significant(relmse),
        "cpu_s": significant(cpu_s),
        "efficiency": 1.0 / (relmse * cpu_s),
        "line": significant(largest_line(errors)),
        "edge": significant(_at_edges(errors)),
    }


def largest_line(errors: list[Channel]) -> float:
    """The largest power of a line at a multiple of the blocks' frequency, across or down, over that of the
    neighbouring lines."""
    power = np.mean([np.abs(np.fft.fft2(each - each.mean())) ** 2 for each in errors], axis=0)
    return max(_line(power.mean(axis=0)), _line(power.mean(axis=1)))


def _line(power: Channel) -> float:
    """Of a spectrum along one direction."""
    found = 0.0
    for multiple in range(1, _BLOCK // 2 + 1):
        at = round(multiple * power.size / _BLOCK)
        beside = [(at + step) % power.size for step in range(-_NEAR, _NEAR + 1) if step]
        found = max(found, float(power[at % power.size] / power[beside].mean()))
    return found


def _at_edges(errors: list[Channel]) -> float:
    """Mean squared error of pixels within a block of a tile's edge, over that of the others."""
    height, width = errors[0].shape
    down, across = (_near_an_edge(size) for size in (height, width))
    near = down[:, None] | across[None, :]
    squares = np.mean([each**2 for each in errors], axis=0)
    return float(squares[near].mean() / squares[~near].mean())


def _near_an_edge(size: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    place = np.arange(size) % TILE_SIZE
    return (place < _BLOCK) | (place >= TILE_SIZE - _BLOCK)


def _write(name: str, y: Channel, reference: Channel) -> None:
    """As sRGB would show it, the reference's brightest twentieth white."""
    level = np.clip(y / np.percentile(reference, 95), 0, 1) ** (1 / 2.2)
    shown = np.repeat(np.repeat(level, _ENLARGED, axis=0), _ENLARGED, axis=1)
    PICTURES.mkdir(parents=True, exist_ok=True)
    image = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(shown.shape[1], shown.shape[0], 1, OpenImageIO.UINT8))
    image.set_pixels(OpenImageIO.ROI(), shown[..., None].astype(np.float32))
    if not image.write(str(PICTURES / f"{name}.png")):
        raise OSError(f"{name}.png: {image.geterror()}")
