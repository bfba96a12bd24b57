"""Unified glare ratings of an office's luminaires in rendered panoramas, against CIE 117:1995, equation 4.1.

Six luminaires of 0.6 m x 0.6 m in the ceiling of an office of 6 m x 5 m have a steep batwing distribution. A
lighting engineer's own program of that equation, which takes each luminaire as a point and the background
as it was met in the furnished room, rates them 16.2 along the room and 15.6 across it. Here the background is
a light that is the same all around, so that nothing is reflected, and luminaires are summed patch by patch.

Seen from these two places they have from 320 to 3,700 cd/m2: a threshold of 2,000 cd/m2 leaves most out.
"""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_client.contract import Glare
from nocturne_client.local.measuring import glare_of_file
from nocturne_client.local.render import LocalRender, render_scene

pytestmark = pytest.mark.system

Values = npt.NDArray[np.float64]

OFFICE: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "office.json").read_text())
GAMMA = np.array(OFFICE["gamma"])
INTENSITY = np.array(OFFICE["intensity"])
"""cd, in the planes C = 0, 45 and 90 degrees, symmetric in both; 0.8 of it in the office."""
SHARE = 0.8
EDGE, HEIGHT = 0.6, 2.799
MIDDLES = [(x, z) for x in (1.0, 3.0, 5.0) for z in (1.25, 3.75)]
FILM = (384, 192)


@dataclass(frozen=True)
class Eye:
    """Who rates; metres, y up."""

    position: tuple[float, float, float]
    look_at: tuple[float, float, float]
    background: float
    """cd/m2."""
    published: float


ALONG = Eye((0.3, 1.2, 2.5), (6.0, 1.2, 2.5), 27.5, 16.2)
ACROSS = Eye((3.0, 1.2, 4.7), (3.0, 1.2, 0.0), 26.9, 15.6)


def intensity(gamma: Values, plane: Values) -> Values:
    """Linear in both angles, degrees."""
    plane = np.abs((plane + 90.0) % 180.0 - 90.0)
    planes = [np.interp(gamma, GAMMA, row) for row in INTENSITY]
    low = planes[0] + (planes[1] - planes[0]) * plane / 45.0
    high = planes[1] + (planes[2] - planes[1]) * (plane - 45.0) / 45.0
    found: Values = SHARE * np.where(plane < 45.0, low, high)
    return found


def guth(right: float, up: float, forward: float) -> float:
    """Position index above the line of sight, as Levin's formula has it."""
    sigma = math.degrees(math.acos(forward))
    tau = math.degrees(math.atan2(abs(right), up))
    return math.exp(
        (35.2 - 0.31889 * tau - 1.22 * math.exp(-2 * tau / 9)) * 1e-3 * sigma
        + (21 + 0.26667 * tau - 0.002963 * tau * tau) * 1e-5 * sigma * sigma
    )


def rating(eye: Eye) -> float:
    """8 log10(0.25 / L_b sum(L^2 w / p^2)): mean luminance over the solid angle, at its middle."""
    position = np.array(eye.position)
    forward = np.array(eye.look_at) - position
    forward /= np.linalg.norm(forward)
    up = np.array([0.0, 1.0, 0.0])
    right = np.cross(forward, up)
    steps = (np.arange(60) + 0.5) / 60 * EDGE - EDGE / 2
    patches = np.stack(np.meshgrid(steps, [HEIGHT], steps, indexing="ij"), axis=-1).reshape(-1, 3)
    total = hidden = 0.0
    for x, z in MIDDLES:
        towards = patches + (np.array([x, 0.0, z]) - position)
        distance = np.linalg.norm(towards, axis=1)
        towards /= distance[:, None]
        gamma = np.degrees(np.arccos(towards[:, 1]))
        luminance = intensity(gamma, np.degrees(np.arctan2(-towards[:, 2], -towards[:, 0])))
        luminance /= EDGE**2 * towards[:, 1]
        solid_angle = EDGE**2 / len(patches) * towards[:, 1] / distance**2
        mean = float(np.sum(luminance * solid_angle) / np.sum(solid_angle))
        middle = np.sum(towards * (luminance * solid_angle)[:, None], axis=0)
        middle /= np.linalg.norm(middle)
        index = guth(float(middle @ right), float(middle @ up), float(middle @ forward))
        total += mean**2 * float(np.sum(solid_angle)) / index**2
        hidden += float(np.sum(solid_angle * (towards @ forward)))
    return 8.0 * math.log10(0.25 / (eye.background * (1.0 - hidden / math.pi)) * total)


def rated(eye: Eye, folder: Path, threshold: float | None = None) -> Glare:
    """The rating of the rendered image, of `FILM` pixels."""
    table = "\n".join(" ".join(f"{each:.3f}" for each in row) for row in INTENSITY)
    angles = " ".join(f"{each:g}" for each in GAMMA)
    head = f"IESNA:LM-63-2002\nTILT=NONE\n1 3600 {SHARE} 19 3 1 2 {EDGE} {EDGE} 0\n1 1 30\n"
    (folder / "batwing.ies").write_text(f"{head}{angles}\n0 45 90\n{table}\n")
    black = {"type": "lambertian", "reflectance": 0.0}
    surfaces = [
        {
            "shape": {
                "type": "quad",
                "corner": [x - EDGE / 2, HEIGHT, z - EDGE / 2],
                "edge_u": [EDGE, 0, 0],
                "edge_v": [0, 0, EDGE],
            },
            "kernel": black,
            "luminaire": {
                "radiance": {"illuminant": "E", "luminance": 1},
                "profile": {"asset": "batwing.ies"},
            },
        }
        for x, z in MIDDLES
    ]
    scene = {
        "nocturne": 1,
        "sensor": {"type": "panorama", "position": eye.position, "look_at": eye.look_at},
        "environment": {"radiance": {"illuminant": "E", "luminance": eye.background}},
        "surfaces": surfaces,
    }
    (folder / "scene.json").write_text(json.dumps(scene))
    image = folder / "image.exr"
    render_scene(LocalRender(folder / "scene.json", [image], *FILM, samples=16, threads=2))
    return glare_of_file(image, "panorama", 180.0, (0.0, 0.0, threshold))


@pytest.mark.parametrize("eye", [ALONG, ACROSS], ids=["along", "across"])
def test_an_office_has_its_rating(eye: Eye, tmp_path: Path) -> None:
    truth = rating(eye)
    # Luminaires as points: the nearest are a metre away from what that takes them for.
    assert truth == pytest.approx(eye.published, abs=0.2)
    found = rated(eye, tmp_path)
    assert len(found.sources) == len(MIDDLES)
    assert found.ugr == pytest.approx(truth, abs=0.1)
    assert found.background_luminance == pytest.approx(eye.background, rel=0.03)


def test_a_threshold_leaves_luminaires_out(tmp_path: Path) -> None:
    found = rated(ALONG, tmp_path, 2000.0)
    assert found.ugr is not None
    assert found.ugr < rating(ALONG) - 3.0
