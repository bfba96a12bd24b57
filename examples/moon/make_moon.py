"""Writes the ground, the planet and the document of this scene next to itself, or into a folder.

The ground is a field of heights with craters at random; lengths are metres.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import trimesh
from numpy.typing import NDArray

SIDE = 900
"""Points of the ground along each side."""
LEFT, RIGHT, FAR, NEAR = -70.0, 70.0, -130.0, 10.0
Values = NDArray[np.float64]
Part = dict[str, Any]


def main(folder: Path) -> None:
    """Write ground.ply, planet.png and scene.json into `folder`."""
    random = np.random.default_rng(11)
    ground().export(folder / "ground.ply")
    _write(folder / "planet.png", planet(random))
    (folder / "scene.json").write_text(json.dumps(scene(), indent=1) + "\n")


def heights(x: Values, z: Values) -> Values:
    """Of the ground: bowls whose depth is a fifth of their radius, with a raised rim, and hills far away."""
    random = np.random.default_rng(3)
    y = np.zeros_like(x)
    for number in range(1500):
        radius = float(np.exp(random.normal(-0.4, 0.75))) * (6 if number < 16 else 1)
        there = random.uniform((LEFT, FAR), (RIGHT, NEAR))
        away = np.hypot(x - there[0], z - there[1]) / radius
        if radius < 9 and np.hypot(there[0] + 0.9, there[1] + 8.0) > radius + 2.0:
            bowl = (away**2 - 1) * 0.2 * radius + 0.05 * radius
            y += np.where(away < 1, bowl, 0.05 * radius * np.exp(-3.2 * (away - 1)))
    for left, away, tall, wide in ((-34, -112, 9, 380), (28, -124, 8, 520), (4, -127, 3, 120)):
        y += tall * np.exp(-((x - left) ** 2 + (z - away) ** 2) / wide)
    return y


def ground() -> trimesh.Trimesh:
    """Its normals point upwards."""
    x, z = np.meshgrid(np.linspace(LEFT, RIGHT, SIDE), np.linspace(FAR, NEAR, SIDE))
    points = np.stack([x, heights(x, z), z], axis=-1).reshape(-1, 3)
    at = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[:-1, 1:], at[1:, 1:]
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([b, d, c], axis=-1)]).reshape(-1, 3)
    return trimesh.Trimesh(np.round(points, 4), faces, process=False)


def planet(random: np.random.Generator) -> NDArray[np.uint8]:
    """Seas, lands and clouds of a planet like the Earth, sRGB; invented."""
    land, cloud = (_noise(random, power) for power in (1.9, 1.5))
    image = np.where(land[..., None] > 0.15, np.array([96, 92, 58]), np.array([16, 42, 96]))
    cover = np.clip((cloud - 0.1) * 1.4, 0, 0.95)[..., None]
    pole = np.abs(np.linspace(-1, 1, image.shape[0]))[:, None, None] > 0.88
    image = np.where(pole, 225, image * (1 - cover) + 235 * cover)
    return image.astype(np.uint8)


def _noise(random: np.random.Generator, power: float) -> Values:
    """Noise with a spectrum that falls with a power of the frequency, of unit variance."""
    shape = (256, 512)
    rows, columns = np.fft.fftfreq(shape[0])[:, None], np.fft.fftfreq(shape[1])[None, :]
    size = np.hypot(2 * rows, columns)
    size[0, 0] = np.inf
    waves = np.fft.fft2(random.normal(size=shape)) / size**power
    noise = np.fft.ifft2(waves).real
    found: Values = noise / noise.std()
    return found


def scene() -> Part:
    """The document."""
    surfaces = [
        {
            "name": "ground",
            "shape": {"type": "mesh", "asset": "ground.ply", "smooth": True},
            "kernel": "dust",
        },
        {
            "name": "planet",
            "shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 42},
            "kernel": {"type": "lambertian", "reflectance": {"texture": {"asset": "planet.png"}}},
            "rotate": {"axis": [1, 0.1, 0.3], "degrees": 70},
            "translate": [262, 118, -800],
        },
        *lander(-0.9, -8.0, float(heights(np.array([-0.9]), np.array([-8.0]))[0])),
    ]
    return {
        "nocturne": 1,
        "name": "Moon",
        "source": "Made up for this project; the albedo is that of lunar mare. make_moon.py writes it.",
        "note": "No air: the Sun is the only light.",
        "spectra": {"dust": {"table": [[380, 0.08], [550, 0.11], [780, 0.14]]}},
        "kernels": {
            "dust": {"type": "lambertian", "reflectance": "dust"},
            "foil": {"type": "conductor", "index": "Au", "roughness": 0.3},
            "metal": {"type": "conductor", "index": "Al", "roughness": 0.35},
            "white": {"type": "lambertian", "reflectance": 0.75},
        },
        "distant": [{"direction": [-0.8, 0.3, 0.3], "sun": True, "limb_darkening": True}],
        "sensor": {
            "type": "pinhole",
            "position": [-0.6, 2.6, 4.5],
            "look_at": [1.6, 1.95, -12.0],
            "vertical_field_of_view_degrees": 34,
        },
        "surfaces": surfaces,
    }


def lander(x: float, z: float, y: float) -> list[Part]:
    """A small craft on four legs."""
    parts = [
        _box("stage", (-0.8, 0.7, -0.8), (0.8, 1.4, 0.8), "foil"),
        _box("cabin", (-0.5, 1.4, -0.5), (0.5, 2.1, 0.5), "white"),
        _box("mast", (-0.03, 2.1, -0.03), (0.03, 2.9, 0.03), "metal"),
        {
            "name": "dish",
            "shape": {
                "type": "disc",
                "centre": [0, 2.75, 0.06],
                "normal": [-0.85, 0.35, 0.4],
                "radius": 0.38,
            },
            "kernel": "white",
        },
        {
            "name": "engine",
            "shape": {"type": "sphere", "centre": [0, 0.62, 0], "radius": 0.36},
            "kernel": "metal",
        },
    ]
    for degrees in (45, 135, 225, 315):
        leg = _box("leg", (0.7, -0.04, -0.04), (1.75, 0.04, 0.04), "metal")
        turn, lean = np.deg2rad(degrees), np.deg2rad(-38)
        axis = _axis_angle(turn, lean)
        centre = [1.45 * np.cos(turn), 0.05, -1.45 * np.sin(turn)]
        rounded = [round(float(each), 3) for each in centre]
        foot = {"type": "disc", "centre": rounded, "normal": [0, 1, 0], "radius": 0.22}
        parts += [
            leg | {"rotate": axis, "translate": [0, 1.15, 0]},
            {"name": "foot", "shape": foot, "kernel": "metal"},
        ]
    for part in parts:
        a, b, c = part.get("translate", [0, 0, 0])
        part["translate"] = [round(a + x, 3), round(b + y, 3), round(c + z, 3)]
    return parts


def _axis_angle(turn: float, lean: float) -> Part:
    """Leaned about z, then turned about y, as one rotation."""
    half, other = 0.5 * lean, 0.5 * turn
    w, vx, vy, vz = (
        np.cos(half) * np.cos(other),
        np.sin(half) * np.sin(other),
        np.cos(half) * np.sin(other),
        np.sin(half) * np.cos(other),
    )
    degrees = 2 * np.rad2deg(np.arccos(w))
    return {"axis": [round(float(each), 5) for each in (vx, vy, vz)], "degrees": round(float(degrees), 3)}


def _box(name: str, low: tuple[float, float, float], high: tuple[float, float, float], kernel: str) -> Part:
    return {
        "name": name,
        "shape": {"type": "box", "minimum": list(low), "maximum": list(high)},
        "kernel": kernel,
    }


def _write(file: Path, pixels: NDArray[np.uint8]) -> None:
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8")
    picture = oiio.ImageBuf(spec)
    picture.set_pixels(oiio.ROI(), pixels)
    if not picture.write(str(file)):
        raise OSError(picture.geterror())


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
