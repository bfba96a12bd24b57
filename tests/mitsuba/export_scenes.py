"""Scenes that try, in few pixels, each thing that can be exported."""

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.media.grid_files import create

Document = dict[str, Any]

_PINHOLE = {
    "type": "pinhole",
    "position": [0, 1.2, 5],
    "look_at": [0, 0.8, 0],
    "vertical_field_of_view_degrees": 36,
}
_FLOOR = {
    "shape": {"type": "quad", "corner": [-4, 0, -4], "edge_u": [0, 0, 8], "edge_v": [8, 0, 0]},
    "kernel": {"type": "lambertian", "reflectance": {"table": [[400, 0.2], [550, 0.6], [700, 0.4]]}},
}
_LAMP = {
    "shape": {"type": "quad", "corner": [-1, 3, -1], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2]},
    "kernel": {"type": "lambertian", "reflectance": 0.0},
    "luminaire": {"radiance": {"blackbody": 3500, "luminance": 5000}},
}
_SKY = {"radiance": {"illuminant": "D65", "luminance": 300}}


def _scene(*surfaces: Document, **parts: Any) -> Document:
    return {
        "nocturne": 1,
        "sensor": _PINHOLE,
        "surfaces": [_FLOOR, _LAMP, *surfaces],
        "environment": _SKY,
        **parts,
    }


def _ball(x: float, radius: float = 0.8, **fields: Any) -> Document:
    return {"shape": {"type": "sphere", "centre": [x, radius + 1e-3, 0], "radius": radius}, **fields}


def _card(kernel: Document) -> Document:
    """Upright, with texture coordinates."""
    shape = {"type": "quad", "corner": [-1.2, 0.1, 0], "edge_u": [2.4, 0, 0], "edge_v": [0, 1.6, 0]}
    return {"shape": shape, "kernel": kernel}


def dyed_glass(folder: Path) -> Document:
    """A dielectric that absorbs by wavelength."""
    del folder
    dye = {"absorption": {"table": [[400, 2.0], [550, 0.1], [700, 1.0]]}}
    return _scene(
        _ball(0, kernel={"type": "dielectric", "index": 1.5}, interior={"media": ["dye"]}), media={"dye": dye}
    )


def cloud(folder: Path) -> Document:
    """A boundary that is not seen; forward scattering with coefficients that depend on wavelength."""
    del folder
    mist = {
        "absorption": 0.2,
        "scattering": {"table": [[400, 2.0], [700, 0.8]]},
        "phase": {"type": "double_henyey_greenstein", "first": 0.7, "second": -0.3, "weight": 0.8},
    }
    return _scene(_ball(0, interior={"media": ["mist"]}), media={"mist": mist})


def underwater(folder: Path) -> Document:
    """The sensor and a lamp are in a medium."""
    del folder
    water = {
        "absorption": {"table": [[400, 0.02], [700, 0.2]]},
        "scattering": 0.1,
        "phase": {"type": "rayleigh"},
    }
    pool = {
        "shape": {"type": "box", "minimum": [-5, -1, -5], "maximum": [5, 5, 6]},
        "interior": {"media": ["water"]},
    }
    return _scene(pool, _ball(0, kernel={"type": "lambertian", "reflectance": 0.7}), media={"water": water})


def everywhere(folder: Path) -> Document:
    """A medium that is everywhere, a lamp in it, and glass that keeps it out."""
    del folder
    scene = _scene(
        _ball(-0.8, radius=0.7, kernel={"type": "dielectric", "index": 1.33}),
        media={
            "haze": {"absorption": 0.05, "scattering": 0.1, "phase": {"type": "henyey_greenstein", "g": 0.5}}
        },
        unbounded_media=["haze"],
    )
    del scene["environment"]
    return scene


def puff(folder: Path) -> Document:
    """Smoke on a grid, linear between voxels, turned, with an albedo that depends on wavelength."""
    return _scene(_puff(), media={"smoke": _smoke(folder, nearest=False)})


def blocks(folder: Path) -> Document:
    """The same, constant over each voxel, in a glass ball that cuts the grid."""
    ball = _ball(0.2, kernel={"type": "dielectric", "index": 1.2}, interior={"media": ["smoke"]})
    return _scene(ball, media={"smoke": _smoke(folder, nearest=True)})


def _puff() -> Document:
    return {"shape": {"type": "medium_box", "medium": "smoke"}, "interior": {"media": ["smoke"]}}


def _smoke(folder: Path, *, nearest: bool) -> Document:
    density = np.random.default_rng(36).uniform(0, 1, (5, 7, 6)) ** 3
    create(folder / "smoke.vdb", "density", density, 0.25)
    return {
        "absorption": {"table": [[400, 4.0], [700, 1.0]]},
        "scattering": {"table": [[400, 3.0], [700, 6.0]]},
        "phase": {"type": "henyey_greenstein", "g": 0.6},
        "density": {
            "asset": "smoke.vdb",
            "grid": "density",
            "factor": 1.5,
            "nearest": nearest,
            "rotate": {"axis": [0.2, 1, 0.1], "degrees": 25},
            "translate": [-0.8, 0.4, -0.4],
        },
    }


def pictures(folder: Path) -> Document:
    """A colour texture, turned by nothing but repeated and shifted; a mask and a blend by grey ones."""
    _picture(folder / "colours.exr", [[0.8, 0.2, 0.1], [0.1, 0.7, 0.2], [0.2, 0.2, 0.7], [0.6, 0.6, 0.6]])
    _picture(folder / "grey.exr", [[0.1], [0.4], [0.7], [1.0]])
    coloured = {
        "type": "lambertian",
        "reflectance": {"texture": "colours", "scale": [1.5, 2.0], "offset": [0.25, 0.5]},
    }
    blend = {
        "type": "blend",
        "first": coloured,
        "second": {"type": "conductor", "index": "Cu", "roughness": 0.3, "distribution": "beckmann"},
        "weight": {"texture": "grey", "gain": 0.5},
    }
    mask = {"type": "mask", "kernel": blend, "opacity": {"texture": "grey"}}
    textures = {
        name: {"asset": f"{name}.exr", "encoding": "linear", "sharp": True} for name in ("colours", "grey")
    }
    return _scene(_card(mask), textures=textures)


def panes(folder: Path) -> Document:
    """A thin pane before a two-sided card and a ball of smooth plastic, through a lens."""
    del folder
    pane = {
        "shape": {"type": "quad", "corner": [-2, 0.05, 1.5], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]},
        "kernel": {"type": "thin_pane", "index": 1.5},
    }
    sides = {
        "type": "two_sided",
        "front": {"type": "lambertian", "reflectance": 0.2},
        "back": {"type": "conductor", "index": "Ag"},
    }
    card = {
        "shape": {
            "type": "quad",
            "corner": [-1.4, 0.05, 0],
            "edge_u": [0.1, 1.4, 0],
            "edge_v": [1.0, 0, -0.6],
        },
        "kernel": sides,
    }
    plastic = {"type": "coated_diffuse", "index": 1.5, "reflectance": {"rgb": [0.1, 0.3, 0.7]}}
    lens = {**_PINHOLE, "type": "thin_lens", "lens_radius": 0.05, "focus_distance": 5}
    return _scene(pane, card, _ball(0.8, radius=0.7, kernel=plastic), sensor=lens)


def meter(folder: Path) -> Document:
    """What falls on a plane, upright and turned, from a lamp, the floor and a ball of glass."""
    del folder
    plane = {
        "type": "irradiance_meter",
        "position": [0.6, 1.2, 1.4],
        "normal": [-0.3, 0.2, -1],
        "up": [0.3, 1, 0],
        "height": 1.2,
    }
    return _scene(_ball(0, kernel={"type": "dielectric", "index": 1.5}), sensor=plane)


def instances(folder: Path) -> Document:
    """A group that stands in the scene three times, in one of them smooth and turned."""
    del folder
    box = {
        "shape": {"type": "box", "minimum": [-0.3, 0, -0.3], "maximum": [0.3, 0.5, 0.3]},
        "kernel": {"type": "lambertian", "reflectance": 0.5},
    }
    ball = {
        "shape": {"type": "sphere", "centre": [0, 0.75, 0], "radius": 0.25},
        "kernel": {"type": "conductor", "index": "Au", "roughness": 0.2},
    }
    placed = [
        {"group": "post", "translate": [-1.2, 0, 0]},
        {"group": "post", "translate": [0, 0, -1], "scale": 1.5},
        {"group": "post", "translate": [1.2, 0, 0], "rotate": {"axis": [0, 1, 0], "degrees": 40}},
    ]
    return _scene(groups={"post": [box, ball]}, instances=placed)


def bodies(folder: Path) -> Document:
    """Instances of a group with a bowl of dyed glass and a ball of mist, one of them turned and larger."""
    del folder
    media = {
        "dye": {"absorption": {"table": [[400, 2.0], [550, 0.1], [700, 1.0]]}},
        "mist": {
            "absorption": 0.3,
            "scattering": {"table": [[400, 4.0], [700, 2.0]]},
            "phase": {"type": "henyey_greenstein", "g": 0.5},
        },
    }
    glass = {
        "shape": {"type": "box", "minimum": [-0.3, 0.01, -0.3], "maximum": [0.3, 0.5, 0.3]},
        "kernel": {"type": "dielectric", "index": 1.5},
        "interior": {"media": ["dye"]},
    }
    mist = {
        "shape": {"type": "sphere", "centre": [0, 0.85, 0], "radius": 0.3},
        "interior": {"media": ["mist"]},
    }
    placed = [
        {"group": "bowl", "translate": [-0.9, 0, 0.5]},
        {
            "group": "bowl",
            "translate": [0.8, 0, -0.5],
            "scale": 1.5,
            "rotate": {"axis": [0, 1, 0], "degrees": 40},
        },
    ]
    return _scene(groups={"bowl": [glass, mist]}, instances=placed, media=media)


def suns(folder: Path) -> Document:
    """Two discs at infinity, one darker towards its edge, on a ball of air and one of rough metal."""
    del folder
    air = {"scattering": 2.0, "phase": {"type": "rayleigh", "depolarisation": 0.4}}
    discs = [
        {"direction": [0.3, 1, 0.4], "sun": True, "limb_darkening": True},
        {
            "direction": [-1, 0.7, 0.9],
            "angular_diameter_degrees": 5,
            "irradiance": {"blackbody": 2800, "luminance": 1e5},
        },
    ]
    return _scene(
        _ball(-0.9, interior={"media": ["air"]}),
        _ball(0.9, kernel={"type": "conductor", "index": "Al", "roughness": 0.3}),
        media={"air": air},
        distant=discs,
    )


def sky(folder: Path) -> Document:
    """An environment map, turned, smooth as that of a renderer that interpolates; a mirror shows it."""
    rows, columns = 64, 128
    down, across = np.mgrid[:rows, :columns] + 0.5
    window = np.exp(-0.5 * (((down - 16) / 3) ** 2 + ((across - 30) / 4) ** 2))
    ground = 0.3 + 0.35 * (1 + np.tanh((32 - down) / 5))
    pixels = np.stack(
        [ground, np.full((rows, columns), 0.5), 0.5 + 0.4 * np.sin(2 * np.pi * across / columns)]
    )
    _picture_of(folder / "sky.exr", np.moveaxis(pixels + 40 * window, 0, -1))
    environment = {"asset": "sky.exr", "luminance": 800, "up": [0.1, 1, 0], "forward": [0.5, 0, -1]}
    return _scene(
        _ball(-0.9, kernel={"type": "conductor", "index": "Al", "roughness": 0.1}),
        _ball(0.9, kernel={"type": "dielectric", "index": 1.5}),
        environment=environment,
    )


def night(folder: Path) -> Document:
    """Without a sky: a lamp that lets light through, seen before black, and a floor that passes most."""
    del folder
    floor = {
        **_FLOOR,
        "kernel": {"type": "blend", "first": _FLOOR["kernel"], "second": {"type": "null"}, "weight": 0.6},
    }
    lamp = {
        "shape": {"type": "quad", "corner": [-0.5, 0.5, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]},
        "kernel": {"type": "null"},
        "luminaire": {"radiance": {"illuminant": "D65", "luminance": 900}, "two_sided": False},
    }
    return {"nocturne": 1, "sensor": _PINHOLE, "surfaces": [floor, _LAMP, lamp]}


SCENES = {
    each.__name__: each
    for each in (
        dyed_glass,
        cloud,
        underwater,
        everywhere,
        puff,
        blocks,
        pictures,
        panes,
        meter,
        instances,
        bodies,
        suns,
        sky,
        night,
    )
}


def _picture(path: Path, colours: list[list[float]]) -> None:
    """Two by two squares of 32 pixels."""
    squares = np.array(colours).reshape(2, 2, -1)
    _picture_of(path, squares.repeat(32, axis=0).repeat(32, axis=1))


def _picture_of(path: Path, pixels: Any) -> None:
    height, width, channels = pixels.shape
    image = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, oiio.FLOAT))
    image.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels, dtype=np.float32))
    assert image.write(str(path))
