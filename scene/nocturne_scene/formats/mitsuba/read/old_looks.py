"""What materials and textures of Mitsuba 0.x say in the words of Mitsuba 3.

Each rule's docstring has its source: a file of Mitsuba 0.6 below src, if no other is named.
"""

from collections.abc import Callable

from nocturne_scene.formats.mitsuba.read.elements import Element, numbers
from nocturne_scene.formats.mitsuba.read.old import Old
from nocturne_scene.formats.mitsuba.read.old_values import made, said

_SCATTERED = (
    "reflectance",
    "diffuse_reflectance",
    "specular_reflectance",
    "transmittance",
    "diffuse_transmittance",
    "specular_transmittance",
    "opacity",
)
# The largest value that is left of colours above 1, which would make light.
_CONSERVED = 0.99


def _material(old: Old) -> None:
    """librender/bsdf.cpp: what would reflect more than all light reflects a little less than that."""
    for child in old.element.children:
        if child.name not in _SCATTERED or child.tag not in ("rgb", "spectrum"):
            continue
        if ":" in child.attributes.get("value", ":"):
            continue
        values = numbers(child.attributes["value"], child.place)
        if (most := max(values, default=0.0)) > 1:
            child.attributes["value"] = " ".join(str(_CONSERVED * value / most) for value in values)
            old.findings.note(
                child.place, f"a colour of up to {most:g} was made darker: no more than 1 is possible"
            )


def _diffuse(old: Old) -> None:
    """parser.cpp of Mitsuba 3; bsdfs/roughdiffuse.cpp."""
    if reflectance := old.find("diffuse_reflectance"):
        reflectance.attributes["name"] = "reflectance"
    if old.element.type == "roughdiffuse":
        old.element.attributes["type"] = "diffuse"
        old.drop("alpha", "use_fast_approx")
        old.note("roughdiffuse became diffuse of the same reflectance: from grazing angles it is less bright")


def _conductor(old: Old) -> None:
    """bsdfs/conductor.cpp, bsdfs/roughconductor.cpp: copper if nothing is said; an index under one."""
    if old.element.type == "conductor":
        old.drop("alpha", "alpha_u", "alpha_v", "distribution", "sample_visible")
    old.drop("diffuse_reflectance")
    outside = old.take("ext_eta")
    own = [child for child in (old.find("eta"), old.find("k")) if child is not None]
    if not own and old.find("material") is None:
        old.add("string", "material", "Cu")
    if outside is not None and outside.tag != "string":
        index = numbers(outside.need("value"), outside.place, 1)[0]
        if abs(index - 1) > 1e-3 and index > 0:
            for child in own:
                _divide(old, child, index)
    elif outside is not None and outside.need("value").lower() not in ("air", "vacuum"):
        old.lose('no support for an "extEta" by name other than air and vacuum; taken as air')
    _distribution(old)


def _divide(old: Old, value: Element, by: float) -> None:
    if value.tag not in ("rgb", "float", "spectrum") or ":" in value.attributes.get("value", ":"):
        old.lose(f'no support for an "extEta" beside a table of "{value.name}"')
        return
    scaled = (each / by for each in numbers(value.need("value"), value.place))
    value.attributes["value"] = " ".join(map(str, scaled))


def _distribution(old: Old) -> None:
    """bsdfs/microfacet.h: `phong` and `as` have exponents that make them as wide as Beckmann's of alpha."""
    found = old.find("distribution")
    if found is not None:
        name = found.need("value").lower()
        if name in ("phong", "as"):
            old.note(f'facets distributed as "{name}" became those of beckmann of the same alpha')
            name = "beckmann"
        found.attributes["value"] = name


def _dielectric(old: Old) -> None:
    """bsdfs/dielectric.cpp: what a smooth plugin doesn't read it warns of."""
    old.drop("alpha", "alpha_u", "alpha_v", "distribution")


def _plastic(old: Old) -> None:
    """bsdfs/plastic.cpp, whose `nonlinear` was `preserveColors` before."""
    if (kept := old.take("preserve_colors")) is not None:
        old.set("boolean", "nonlinear", "false" if kept.need("value") == "true" else "true")
    _distribution(old)


def _mirror(old: Old) -> None:
    """0.3.0.xsl: of chromium."""
    old.element.attributes["type"] = "conductor"
    old.set("string", "material", "Cr")


def _mixture(old: Old) -> None:
    """bsdfs/mixturebsdf.cpp: a sum of any number of materials, here of two at a time; the rest is black."""
    inside = [child for child in old.element.children if old.kind(child) == "bsdf"]
    old.element.children = [child for child in old.element.children if child not in inside]
    weights = numbers(old.text("weights", "").replace(";", " "), old.element.place)
    total = sum(weights)
    if len(inside) != len(weights) or not inside or min(weights) < 0 or not total > 0:
        old.lose("a mixturebsdf needs as many weights, not negative, as materials")
        return
    if total > 1:  # as 0.6 does
        weights, total = [weight / total for weight in weights], 1.0
    place = old.element.place
    if total < 1 - 1e-6:
        black = made("bsdf", place, said("rgb", "reflectance", 0, place), type="diffuse")
        inside, weights = [black, *inside], [1 - total, *weights]
    if len(inside) == 1:
        inside, weights = inside * 2, [0.5, 0.5]
    found, share = inside[0], weights[0]
    for each, weight in zip(inside[1:], weights[1:], strict=True):
        share += weight
        part = said("float", "weight", weight / share if share > 0 else 0, place)
        found = made("bsdf", place, found, each, part, type="blendbsdf")
    old.element.attributes["type"] = "blendbsdf"
    old.element.children += found.children


def _bump_map(old: Old) -> None:
    """bsdfs/bumpmap.cpp: the texture is unnamed; of a bitmap it wants the gamma, which is 1 for heights."""
    old.name_nested("texture", "arbitrary")


def _normal_map(old: Old) -> None:
    """bsdfs/normalmap.cpp."""
    old.name_nested("texture", "normalmap")


def _texture(old: Old) -> None:
    """librender/texture.cpp: uv times scale plus offset (parser.cpp of Mitsuba 3 scales the offset, too)."""
    both = old.number("uvscale", 1.0)
    scale = [old.number(name, both) for name in ("uscale", "vscale")]
    offset = [old.number(name, 0.0) for name in ("uoffset", "voffset")]
    old.drop("coordinates")
    if scale == [1.0, 1.0] and offset == [0.0, 0.0]:
        return
    place = old.element.place
    steps = (
        made("scale", place, x=str(scale[0]), y=str(scale[1])),
        made("translate", place, x=str(offset[0]), y=str(offset[1])),
    )
    old.element.children.append(made("transform", place, *steps, name="to_uv"))


def _bitmap(old: Old) -> None:
    """textures/bitmap.cpp: a gamma of 1 is linear, -1 sRGB, without one it is as the file says."""
    gamma = old.number("gamma", 0.0)
    if gamma == 1.0:
        old.set("boolean", "raw", "true")
    elif gamma not in (0.0, -1.0):
        old.note(f"pictures of gamma {gamma:g} are decoded by the curve of sRGB")
    if old.text("filter_type", "bilinear") != "bilinear":
        old.note("pictures are looked up by bilinear interpolation, whatever their filterType")
    across, up = old.take("wrap_mode_u"), old.take("wrap_mode_v")
    if across is not None and up is not None and across.need("value") == up.need("value"):
        old.set("string", "wrap_mode", across.need("value"))
    elif across is not None or up is not None:
        old.lose('no support for "wrapModeU" and "wrapModeV" that differ')


def _vertex_colours(old: Old) -> None:
    """textures/vertexcolors.cpp."""
    old.element.attributes["type"] = "mesh_attribute"
    old.add("string", "name", "vertex_color")


LOOKS: dict[tuple[str, str], Callable[[Old], None]] = {
    ("bsdf", ""): _material,
    ("texture", ""): _texture,
    ("texture", "bitmap"): _bitmap,
    ("texture", "vertexcolors"): _vertex_colours,
    ("bsdf", "diffuse"): _diffuse,
    ("bsdf", "roughdiffuse"): _diffuse,
    ("bsdf", "conductor"): _conductor,
    ("bsdf", "roughconductor"): _conductor,
    ("bsdf", "dielectric"): _dielectric,
    ("bsdf", "thindielectric"): _dielectric,
    ("bsdf", "roughdielectric"): _distribution,
    ("bsdf", "plastic"): _plastic,
    ("bsdf", "roughplastic"): _plastic,
    ("bsdf", "mirror"): _mirror,
    ("bsdf", "mixturebsdf"): _mixture,
    ("bsdf", "bumpmap"): _bump_map,
    ("bsdf", "normalmap"): _normal_map,
}
"""By tag and type; an empty type is for all."""
