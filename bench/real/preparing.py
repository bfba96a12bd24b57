"""A scene of Mitsuba 0.x, made so that both renderers can read it and show the same.

What Mitsuba 3 no longer has is written in its new words, files that are missing go (shapes and lamps are left
out, pictures become grey), and everything is traced by plain paths on a film of some 20,000 pixels.
"""

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import OpenImageIO

from bench.real import daylight

PIXELS = 20_000
"""Of a film, about."""

_FILES = ("filename", "file")
# Colours that were sRGB before they became linear in name.
_HEX = re.compile(r"#[0-9a-fA-F]{6}")
_GREY, _SKY = "grey.png", "daylight.exr"


class Unprepared(ValueError):
    """A scene that has no film or no camera."""


def prepared(file: Path) -> tuple[Path, tuple[int, int]]:
    """A scene file next to the original one, and its film: width and height. Raises Unprepared."""
    tree = ET.parse(file)  # noqa: S314 - a file of a clone that somebody made on purpose
    root = tree.getroot()
    _write_grey(file.with_name(_GREY))
    for parent in list(root.iter()):
        for child in list(parent):
            if _is_missing(child, file.parent):
                _leave_out(parent, child)
            elif child.tag == "emitter" and child.get("type") in daylight.KINDS:
                daylight.as_picture(child, file.with_name(_SKY))
            else:
                _renew(parent, child)
    for integrator in root.findall("integrator"):
        root.remove(integrator)
    root.insert(0, ET.Element("default", {"name": "sampler", "value": "independent"}))
    root.insert(1, ET.Element("integrator", {"type": "path"}))
    size = _set_film(root, file)
    target = file.with_name("prepared.xml")
    tree.write(target)
    return target, size


def _is_missing(element: ET.Element, folder: Path) -> bool:
    named = [each.get("value", "") for each in element.findall("string") if each.get("name") in _FILES]
    return any(name and "$" not in name and not (folder / name).exists() for name in named)


def _leave_out(parent: ET.Element, child: ET.Element) -> None:
    if child.tag != "texture":
        parent.remove(child)
        return
    for each in child.findall("string"):
        if each.get("name") in _FILES:
            each.set("value", _GREY)


def _write_grey(file: Path) -> None:
    picture = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(2, 2, 3, "uint8"))
    OpenImageIO.ImageBufAlgo.fill(picture, (0.5, 0.5, 0.5))
    picture.write(str(file))


def _renew(parent: ET.Element, child: ET.Element) -> None:
    name, value = child.get("name", ""), child.get("value", "")
    if name in ("use_path_guiding", "usePathGuiding"):
        parent.remove(child)
    elif child.tag in ("srgb", "rgb") and _HEX.fullmatch(value):
        child.tag = "rgb"
        child.set("value", _linear(int(value[at : at + 2], 16) / 255 for at in (1, 3, 5)))
    elif child.tag == "srgb":
        child.tag = "rgb"
        child.set("value", _linear(map(float, value.replace(",", " ").split())))
    elif child.tag == "spectrum" and ":" not in value and len(value.replace(",", " ").split()) == 3:
        child.tag = "rgb"
    elif child.tag == "rgb" and name in ("eta", "k"):
        # Mitsuba's spectral variants read no more than 1 from three numbers, and nothing from 0.
        red, green, blue = (max(1e-4, float(each)) for each in value.replace(",", " ").split())
        child.tag = "spectrum"
        child.set("value", f"360:{blue}, 460:{blue}, 550:{green}, 620:{red}, 830:{red}")
    elif child.tag == "blackbody":
        child.tag = "rgb"
        child.attrib = {"name": name, "value": child.get("scale", "1")}
    elif child.tag == "string" and value in ("trilinear", "ewa"):
        child.set("value", "bilinear")
    elif child.tag == "transform":
        for each in list(child):
            each.tag = each.tag.lower()
            # A mirrored camera, by exporters of old: it shows the same light.
            if each.tag == "scale" and parent.tag == "sensor":
                child.remove(each)
    elif child.tag == "string" and name == "distribution" and value not in ("ggx", "beckmann"):
        child.set("value", "beckmann")
    elif child.tag == "texture" and child.get("type") == "scale":
        for inner in child.findall("ref") + child.findall("texture"):
            inner.set("name", name)
            parent.append(inner)
        parent.remove(child)
    elif child.tag == "bsdf":
        _renew_material(child)


def _renew_material(bsdf: ET.Element) -> None:
    match bsdf.get("type"):
        case "phong" | "ward":
            _as_plastic(bsdf)
        case "roughdiffuse":
            bsdf.set("type", "diffuse")
        case "mixturebsdf":
            bsdf.set("type", "twosided")
            for other in bsdf.findall("bsdf")[1:] + bsdf.findall("ref")[1:] + bsdf.findall("string"):
                bsdf.remove(other)
        case "mask" | "bump" | "bumpmap" | "normalmap":
            # Their numbers are no colours.
            for texture in bsdf.findall("texture"):
                ET.SubElement(texture, "boolean", {"name": "raw", "value": "true"})


def _linear(encoded: Iterable[float]) -> str:
    return ", ".join(f"{v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4:.6f}" for v in encoded)


def _as_plastic(bsdf: ET.Element) -> None:
    """With facets about as rough as the lobe is wide."""
    alpha = 0.1
    for each in list(bsdf):
        match each.get("name"):
            case "exponent":
                alpha = math.sqrt(2.0 / (float(each.get("value", "30")) + 2.0))
            case "alpha":
                alpha = float(each.get("value", "0.1"))
            case "diffuseReflectance" | "diffuse_reflectance":
                continue
        bsdf.remove(each)
    bsdf.set("type", "roughplastic")
    bsdf.append(ET.Element("float", {"name": "alpha", "value": f"{float(np.clip(alpha, 0.05, 0.6)):g}"}))


def _set_film(root: ET.Element, file: Path) -> tuple[int, int]:
    sensor = root.find("sensor")
    film = sensor.find("film") if sensor is not None else None
    if sensor is None or film is None:
        raise Unprepared(f"{file} has no camera with a film")
    width, height = _size(film, root)
    for old in (film, *sensor.findall("sampler")):
        sensor.remove(old)
    ET.SubElement(sensor, "sampler", {"type": "$sampler"})
    new = ET.SubElement(sensor, "film", {"type": "hdrfilm"})
    ET.SubElement(new, "integer", {"name": "width", "value": str(width)})
    ET.SubElement(new, "integer", {"name": "height", "value": str(height)})
    ET.SubElement(new, "rfilter", {"type": "box"})
    return width, height


def _size(film: ET.Element, root: ET.Element) -> tuple[int, int]:
    defaults = {each.get("name"): each.get("value", "") for each in root.findall("default")}

    def edge(name: str, otherwise: int) -> int:
        for each in film.findall("integer"):
            if each.get("name") == name:
                value = each.get("value", "")
                return int(defaults.get(value[1:], "") if value.startswith("$") else value)
        return otherwise

    width, height = edge("width", 768), edge("height", 576)
    shrink = math.sqrt(width * height / PIXELS)
    return round(width / shrink), round(height / shrink)
