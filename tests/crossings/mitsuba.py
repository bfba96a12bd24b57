"""Another renderer as one more method, of what of a scene Mitsuba 3 can have: the rest is left out first."""

import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_client.errors import NocturneClientError, Problem
from nocturne_client.local.exporting import export_to
from nocturne_client.local.programs import CHECKOUT
from nocturne_scene.film import Film
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT

from tests.accuracy.tracing import Document, write
from tests.crossings.methods import Readings, Values, quarters
from tests.crossings.scenes import Scene
from tests.crossings.sensors import CAMERA

PYTHON = CHECKOUT / "build" / "peers" / "bin" / "python"
_SCRIPT = Path(__file__).parents[1] / "mitsuba" / "mitsuba_batches.py"
_ROUNDS = 12
"""Each round removes all reported problems; a scene with further problems is left out."""
_SURFACE = re.compile(r"\$\.surfaces\[(\d+)\](\.?\w*)")
_NOTED = ("hidden_from", "limb_darkening")
_GREY: Document = {"type": "lambertian", "reflectance": 0.5}
_EVEN: Document = {"radiance": 0.01}
_LAMP: Document = {
    "shape": {"type": "quad", "corner": [-0.3, 2.3, -0.3], "edge_u": [0.6, 0, 0], "edge_v": [0, 0, 0.6]},
    "luminaire": _EVEN,
    "kernel": {"type": "lambertian", "reflectance": 0},
}
_PINHOLE: Document = {
    "type": "pinhole",
    "position": CAMERA,
    "look_at": [0.0, 0.5, -0.2],
    "vertical_field_of_view_degrees": 60,
}
_READ: Document = {"asset": "grey.png", "sharp": True}


def exportable(document: Document, folder: Path, film: Film) -> Document | None:
    """The scene without parts that can't be exported; None if no such scene is found."""
    document = _plain(document)
    for _ in range(_ROUNDS):
        try:
            _export(document, folder, film)
        except NocturneClientError as error:
            if not error.problems:
                return None
            document = _without(document, error.problems)
        else:
            return document
    return None


def _export(document: Document, folder: Path, film: Film) -> Path:
    """The scene's file, in a folder that replaces that of the scene before."""
    to = folder / "mitsuba"
    shutil.rmtree(to, ignore_errors=True)
    return export_to(write(document, folder), to, "mitsuba", film).scene


def _without(document: Document, problems: Sequence[Problem]) -> Document:
    made: Document = {**document, "surfaces": [dict(each) for each in document["surfaces"]]}
    gone = set[int]()
    for problem in problems:
        if found := _SURFACE.match(problem.place):
            index = int(found[1])
            if not _mended(made["surfaces"][index], found[2].lstrip("."), problem.message):
                gone.add(index)
            continue
        field = problem.place.removeprefix("$").lstrip(".").partition(".")[0].partition("[")[0]
        match field:
            case "sensor":
                made["sensor"] = _PINHOLE
            case "groups" | "instances":
                made.pop("groups", None)
                made.pop("instances", None)
            case "surfaces":
                # No light is left. A sky would be black in a closed room, and leak into Mitsuba's.
                made["surfaces"].append(_LAMP)
            case _:
                made.pop(field, None)
    made["surfaces"] = [each for index, each in enumerate(made["surfaces"]) if index not in gone]
    return made


def _mended(surface: Document, field: str, message: str) -> bool:
    """Whether it is something that can stay."""
    match field:
        case "kernel":
            if surface.get("kernel") == _GREY:
                return False
            surface["kernel"] = _GREY
            surface.pop("interior", None)
        case "luminaire":
            if surface["luminaire"] == _EVEN:
                return False
            surface["luminaire"] = _EVEN
        case "" if "motion" in message:
            return _drop(surface, "motion")
        case "" if "maps" in message:
            return _drop(surface, "bump_map", "normal_map")
        case _:
            return False
    return True


def _drop(surface: Document, *names: str) -> bool:
    """Whether any was there."""
    found = [surface.pop(name) for name in names if name in surface]
    return bool(found)


def _plain(value: Any) -> Any:
    """The value without features that are exported with a note on a different look, without narrow lines,
    which Mitsuba's evenly drawn wavelengths hit once in thousands, and with textures as Mitsuba reads them:
    without a footprint, which in films of 4 x 4 pixels covers most of a picture, and grey, as other spectra
    stand there for the same RGB, 1 % apart in the light of lamps with peaks."""
    if isinstance(value, dict):
        if "lines" in value:
            return {"constant": 1.0} | {name: each for name, each in value.items() if name != "lines"}
        return {name: _sharp(name, _plain(inner)) for name, inner in value.items() if name not in _NOTED}
    return [_plain(each) for each in value] if isinstance(value, list) else value


def _sharp(name: str, value: Any) -> Any:
    if name == "textures":
        return {each: picture | _READ for each, picture in value.items()}
    return value | _READ if name == "texture" and isinstance(value, dict) else value


def traced(document: Document, scene: Scene, folder: Path, samples: int, seeds: int) -> Readings:
    """By Mitsuba; its images state no errors, so that those are what seeds scatter by."""
    film = Film(scene.width, scene.height, samples)
    exported = _export(document, folder, film)
    images = folder / "images.npy"
    command: list[object] = [PYTHON, "-P", _SCRIPT, "scalar_spectral", exported, samples, seeds, images]
    subprocess.run([*map(str, command)], check=True, capture_output=True)
    means = np.array([_regions(each) for each in np.load(images).astype(np.float64)]) * CANDELAS_PER_UNIT
    errors = np.broadcast_to(means.std(axis=0, ddof=1), means.shape)
    return Readings(("X", "Y", "Z"), means, errors, np.full(means.shape[:2], np.nan), 0.0)


def _regions(image: Values) -> Values:
    """The whole and its quarters, as Readings has them."""
    parts = [image.reshape(-1, 3), *(image[each] for each in quarters(*image.shape[:2]))]
    return np.array([each.mean(axis=0) for each in parts])
