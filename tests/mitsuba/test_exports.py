"""Scenes exported to Mitsuba and rendered by it, against ours, by z-tests.

False alarms for a scene: 0.01 for the tiles, 0.008 for the means. Seeds are fixed.
"""

import json
from pathlib import Path

import pytest
from nocturne_client.local.exporting import export_to
from nocturne_client.local.programs import CHECKOUT
from nocturne_scene.compare.agreement import Estimate, compare
from nocturne_scene.film import Film
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT
from nocturne_scene.formats.reading.options import Imported
from nocturne_scene.formats.reading.scene_writer import FilmSettings

from bench.peer.contenders import frames_of
from bench.scenes import example
from tests.mitsuba.export_scenes import SCENES
from tests.mitsuba.renders import Batches

PYTHON = CHECKOUT / "build" / "peers" / "bin" / "python"

pytestmark = [
    pytest.mark.peers,
    pytest.mark.skipif(not PYTHON.exists(), reason=f"needs Mitsuba in {PYTHON.parents[1]}: `make peers`"),
]

BATCHES, WIDTH, HEIGHT = 12, 32, 24

# Scenes of the repository: samples of a pixel in each batch, ours and theirs.
REPOSITORY = {
    "cornell": (64, 128),
    "colour_chart": (64, 64),
    "subsurface": (32, 64),
    "mixtures": (64, 64),
    "smoke": (32, 128),
}


def theirs(scene: Path, samples: int, folder: Path) -> Estimate:
    """What Mitsuba makes of a scene, in its unit."""
    frames = frames_of(PYTHON, scene, samples, BATCHES, folder)
    return Estimate(frames.mean(axis=0), frames.var(axis=0, ddof=1) / BATCHES, BATCHES - 1)


def check(document: Path, folder: Path, samples: tuple[int, int]) -> None:
    """Both renderers' images must agree, but for noise."""
    exported = export_to(document, folder / "mitsuba", "mitsuba", Film(WIDTH, HEIGHT, samples[1]))
    reference = theirs(exported.scene, samples[1], folder)
    scene = Imported(document, FilmSettings(WIDTH, HEIGHT), [], [])
    image = Batches(scene, folder / "compiled", BATCHES, samples[0]).render()
    found = compare(image, reference)
    assert found.verdict is not None
    verdict = found.verdict
    ratio = ", ".join(f"{each - 1:+.3%}" for each in found.ratio)
    told = (
        f"means {ratio}, z {verdict.mean_z.round(1)}, tiles {verdict.largest_tile:.2g}, "
        f"{verdict.share_explained:.2%} of pixels, Y {image.mean[..., 1].mean() * CANDELAS_PER_UNIT:.4g}"
    )
    print(f"{document.parent.name}: {told}")  # noqa: T201 - figures for tests/mitsuba/README.md
    assert verdict.pixels_agree, told
    assert verdict.sums_agree, told


@pytest.mark.parametrize("name", REPOSITORY)
def test_scene_of_the_repository_looks_the_same(name: str, tmp_path: Path) -> None:
    document = tmp_path / name / "scene.json"
    document.parent.mkdir()
    document.write_text(json.dumps(example(name, document.parent)))
    check(document, tmp_path, REPOSITORY[name])


@pytest.mark.parametrize("name", SCENES)
def test_part_looks_the_same(name: str, tmp_path: Path) -> None:
    folder = tmp_path / name
    folder.mkdir()
    document = folder / "scene.json"
    document.write_text(json.dumps(SCENES[name](folder)))
    check(document, tmp_path, (64, 128))
