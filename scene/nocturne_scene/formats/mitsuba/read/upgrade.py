"""Elements of Mitsuba 0.x in the words of Mitsuba 3, so that its readers need no others.

What changed is in tables, each with its source: "parser.cpp" is transform_upgrade in src/core/parser.cpp of
Mitsuba 3, "0.3.0.xsl" and its like data/schema/upgrade_0.3.0.xsl of Mitsuba 0.6, all else the plugin's own
file in Mitsuba 0.6. Rules of single plugins are in old_plugins.py and old_looks.py, colours and
transformations in old_values.py.
"""

import re
from collections.abc import Callable

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.elements import Element
from nocturne_scene.formats.mitsuba.read.old import Old
from nocturne_scene.formats.mitsuba.read.old_plugins import IGNORED, RULES
from nocturne_scene.formats.mitsuba.read.old_values import snake_case, upgrade_colour, upgrade_steps
from nocturne_scene.formats.reading.findings import Findings

Version = tuple[int, ...]
NEW: Version = (2, 0, 0)
"""From this one on nothing is to be upgraded: parser.cpp."""

# Elements (0.4.0.xsl).
_TAGS = {"camera": "sensor", "luminaire": "emitter"}

# Plugins: 0.3.0.xsl, 0.4.0.xsl, 0.5.0.xsl.
_TYPES = {
    ("bsdf", "lambertian"): "diffuse",
    ("bsdf", "microfacet"): "roughplastic",
    ("bsdf", "roughmetal"): "roughconductor",
    ("bsdf", "roughglass"): "roughdielectric",
    ("bsdf", "composite"): "mixturebsdf",
    ("texture", "exrtexture"): "bitmap",
    ("texture", "ldrtexture"): "bitmap",
    ("integrator", "errctrl"): "adaptive",
    ("film", "exrfilm"): "hdrfilm",
    ("film", "pngfilm"): "ldrfilm",
    ("bsdf", "bump"): "bumpmap",
}

# Parameters, by the plugin that has them or in all of a kind: 0.3.0.xsl, 0.4.0.xsl.
_NAMES = {
    ("shape", "sphere"): {"inverted": "flip_normals"},
    ("texture", "checkerboard"): {"bright_color": "color0", "dark_color": "color1"},
    ("texture", "gridtexture"): {"bright_color": "color0", "dark_color": "color1"},
    ("bsdf", "ward"): {"alpha_x": "alpha_u", "alpha_y": "alpha_v"},
    ("bsdf", "roughplastic"): {"alpha_b": "alpha"},
    ("bsdf", "roughconductor"): {"alpha_b": "alpha"},
    ("bsdf", "roughdielectric"): {"alpha_b": "alpha"},
    ("emitter", "area"): {"intensity": "radiance"},
    ("emitter", "constant"): {"intensity": "radiance"},
    ("emitter", "directional"): {"intensity": "irradiance"},
    ("emitter", "envmap"): {"intensity_scale": "scale"},
    ("sensor", "thinlens"): {"focus_depth": "focus_distance"},
    ("medium", "homogeneous"): {"density_multiplier": "scale", "size_multiplier": "scale"},
    ("medium", "heterogeneous"): {"density_multiplier": "scale", "size_multiplier": "scale"},
}

_COLOURS = ("rgb", "srgb", "spectrum", "blackbody")
_VERSION = re.compile(r"\d+(\.\d+){0,2}")


def version_of(root: Element, around: Version) -> Version:
    """The version that a file is written for; that of the file around it where it says none."""
    text = root.attributes.get("version", "").strip()
    if not text or root.tag != "scene":
        return around
    if not _VERSION.fullmatch(text):
        raise InputError.at(root.place, f'expected a version such as "0.6.0" or "3.0.0", found "{text[:40]}"')
    return tuple(int(part) for part in text.split("."))


def upgrade(
    element: Element, version: Version, findings: Findings, resolve: Callable[[Element], Element]
) -> None:
    """Change an element of a version before `NEW` in place; its children were changed before."""
    if version >= NEW:
        return
    with findings.leaving_out():
        if element.tag == "transform":
            upgrade_steps(element)
            return
        old = Old(element, version, findings, resolve)
        if element.tag == "camera":
            old.fix_handedness()
        element.tag = _TAGS.get(element.tag, element.tag)
        if "type" not in element.attributes:
            return
        _rename(element)
        _keep_last(old)
        for child in element.children:
            if child.tag in _COLOURS:
                upgrade_colour(child, emitted=element.tag == "emitter")
        old.drop(*IGNORED.get((element.tag, ""), ()), *IGNORED.get((element.tag, element.type), ()))
        for kind in ("", element.type):
            if rule := RULES.get((element.tag, kind)):
                rule(old)


def _rename(element: Element) -> None:
    kind = element.type.lower()
    element.attributes["type"] = _TYPES.get((element.tag, kind), kind)
    names = _NAMES.get((element.tag, element.type), {})
    for child in element.children:
        if child.name:
            name = snake_case(child.name)
            child.attributes["name"] = names.get(name, name)


def _keep_last(old: Old) -> None:
    """Of a parameter that is given twice the last counts: core/properties.cpp."""
    last = {child.name: child for child in old.element.children if child.name}
    kept = [child for child in old.element.children if not child.name or last[child.name] is child]
    if len(kept) < len(old.element.children):
        old.note("of a parameter that is given twice the last one counts")
    old.element.children = kept
