"""Materials: Mitsuba's BSDF plugins as kernels.

Most of its materials are black from behind; ours scatter on both sides, so `two_sided` adds a black back.

One file, though long: a short function for each plugin, and their table.
"""

from collections.abc import Callable
from copy import deepcopy

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import lobes, spectra, textures
from nocturne_scene.formats.mitsuba.read.context import Bsdf, Context
from nocturne_scene.formats.mitsuba.read.elements import Element, numbers
from nocturne_scene.formats.mitsuba.read.principled import principled
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading import colours, metals
from nocturne_scene.formats.reading.coats import Coat, base_under, rough_coat, smooth_coat
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.spectra import indices

BLACK = {"type": "lambertian", "reflectance": 0.0}

# Measured at 589 nm and 0 to 20 degrees C: E. Hecht, "Optics", 4th edition; gases and plastics as Mitsuba's
# documentation lists them.
INDICES = {
    "vacuum": 1.0,
    "helium": 1.000036,
    "hydrogen": 1.000132,
    "air": 1.000277,
    "carbon dioxide": 1.00045,
    "water": 1.3330,
    "acetone": 1.36,
    "ethanol": 1.361,
    "carbon tetrachloride": 1.461,
    "glycerol": 1.4729,
    "benzene": 1.501,
    "silicone oil": 1.52045,
    "bromine": 1.661,
    "water ice": 1.31,
    "fused quartz": 1.458,
    "pyrex": 1.470,
    "acrylic glass": 1.49,
    "polypropylene": 1.49,
    "bk7": 1.5046,
    "sodium chloride": 1.544,
    "amber": 1.55,
    "pet": 1.5750,
    "diamond": 2.419,
}
# The metals, and what those of Mitsuba 3.9.1 reflect of light of 550 nm that comes straight down.
_METALS = {"Ag": 0.960, "Al": 0.921, "Au": 0.847, "Cr": 0.659, "Cu": 0.634}
_SAME_METAL = 0.01
# Outside of a body: what a camera stands in.
_THIN = 1.001


def front_only(kernel: Json) -> Json:
    """A kernel that is black from behind."""
    return {"type": "two_sided", "front": kernel, "back": BLACK}


def front_of(kernel: Json) -> Json:
    """What a kernel is from the front, on both sides."""
    match kernel["type"]:
        case "two_sided":
            return kernel["front"]
        case "mask":
            return kernel | {"kernel": front_of(kernel["kernel"])}
        case "blend":
            return kernel | {"first": front_of(kernel["first"]), "second": front_of(kernel["second"])}
    return kernel


def bsdf(context: Context, element: Element) -> Bsdf:
    """Return the material of an element; without a counterpart, grey and a loss.

    Each element becomes one material, however many shapes have it.
    """
    if element.number < 0:
        return _made(context, element)
    if element.number not in context.materials:
        context.materials[element.number] = _made(context, element)
    return deepcopy(context.materials[element.number])


def _made(context: Context, element: Element) -> Bsdf:
    if element.type not in _BSDFS:
        context.findings.lost(
            element.place,
            f'no support for the bsdf "{element.type}"; there are {", ".join(sorted(_BSDFS))}. Taken as grey',
        )
        return Bsdf({"type": "lambertian", "reflectance": 0.5})
    properties = context.properties(element)
    found = Bsdf({"type": "lambertian", "reflectance": 0.5})
    with context.findings.leaving_out():
        found = _BSDFS[element.type](context, properties)
        properties.finish()
    return found


def _diffuse(context: Context, properties: Properties) -> Bsdf:
    reflectance = textures.colour(context, properties, "reflectance", 0.5)
    return Bsdf(front_only({"type": "lambertian", "reflectance": reflectance}))


def _index(properties: Properties, name: str, default: str) -> float:
    """An index of refraction, by name or number."""
    element = properties.take(name)
    if element is None:
        return INDICES[default]
    if element.tag != "string":
        value = numbers(element.need("value"), element.place, 1)[0]
        if not value > 0:
            raise InputError.at(element.place, f"an index of refraction is positive, found {value:g}")
        return value
    known = element.need("value").lower()
    if known not in INDICES:
        raise InputError.at(element.place, f'no index named "{known[:40]}"; expected {", ".join(INDICES)}')
    return INDICES[known]


def _relative_index(context: Context, properties: Properties, inside: str = "bk7") -> float:
    """Of the inside over the outside: all that a boundary depends on."""
    interior, exterior = _index(properties, "int_ior", inside), _index(properties, "ext_ior", "air")
    if exterior > _THIN:
        context.findings.note(
            properties.place, f"a boundary of indices {interior:g} and {exterior:g} became one of their ratio"
        )
    return interior / exterior


def _scales(context: Context, properties: Properties, *names: str) -> None:
    """Factors without a physical meaning: only 1 is supported."""
    for name in names:
        if textures.colour(context, properties, name, 1.0) != 1.0:
            context.findings.lost(properties.place, f'no support for "{name}" other than 1')


def _roughness(context: Context, properties: Properties) -> Json:
    properties.ignore("sample_visible")
    distribution = properties.text("distribution", "beckmann")
    if distribution not in ("beckmann", "ggx"):
        raise InputError.at(
            properties.place, f'no distribution "{distribution[:40]}"; expected beckmann or ggx'
        )
    found: Json = {} if distribution == "ggx" else {"distribution": distribution}
    if not properties.has("alpha_u"):
        return found | {"roughness": textures.number(context, properties, "alpha", 0.1)}
    for axis in ("u", "v"):
        found[f"roughness_{axis}"] = textures.number(context, properties, f"alpha_{axis}", 0.1)
    return found


def _dielectric(context: Context, properties: Properties) -> Bsdf:
    _scales(context, properties, "specular_reflectance")
    passing = textures.colour(context, properties, "specular_transmittance", 1.0)
    if passing == 0.0:
        # Light that goes in is lost, as under a coat over black.
        index = _relative_index(context, properties)
        return Bsdf({"type": "coated_diffuse", "index": index, "reflectance": 0.0})
    if passing != 1.0:
        context.findings.lost(properties.place, 'no support for "specular_transmittance" other than 0 and 1')
    interior, exterior = _index(properties, "int_ior", "bk7"), _index(properties, "ext_ior", "air")
    if exterior > _THIN:
        return Bsdf({"type": "dielectric", "index": interior, "outside": exterior})
    return Bsdf({"type": "dielectric", "index": interior / exterior})


def _rough_dielectric(context: Context, properties: Properties) -> Bsdf:
    smooth = _dielectric(context, properties)
    return Bsdf(smooth.kernel | _roughness(context, properties))


def _thin_dielectric(context: Context, properties: Properties) -> Bsdf:
    _scales(context, properties, "specular_reflectance", "specular_transmittance")
    return Bsdf({"type": "thin_pane", "index": _relative_index(context, properties)})


def _metal(context: Context, properties: Properties) -> Json:
    material = properties.text("material", None)
    if material is not None and material != "none":
        if material not in _METALS:
            raise InputError.at(
                properties.place,
                f'no table of "{material[:40]}"; expected {", ".join(_METALS)}, or eta and k',
            )
        _note_other_table(context, material, properties.place)
        return material
    eta, k = properties.take("eta"), properties.take("k")
    if eta is None or k is None:
        # A perfect mirror, of which Mitsuba says eta = 0 and k = 1: the nearest that can be written.
        context.findings.note(properties.place, "a perfect mirror became a metal that reflects 99.8 %")
        return {"n": 0.001, "k": 1.0}
    return {"n": _part(context, eta), "k": _part(context, k)}


def _note_other_table(context: Context, material: str, place: str) -> None:
    [reflected] = colours.values_of(metals.colour_under(material, 1.0), np.array([550.0]))
    if abs(reflected - _METALS[material]) > _SAME_METAL:
        context.findings.note(
            place,
            f'"{material}" has another table than in Mitsuba ({indices.metal(material).source}): it reflects '
            f"{reflected:.1%} of light of 550 nm, Mitsuba's {_METALS[material]:.1%}; "
            "give eta and k for the same",
        )


def _part(context: Context, element: Element) -> Json:
    """n or k."""
    if element.tag != "rgb":
        return _held(spectra.reflectance(context, element))
    values = spectra.rgb(element)
    if min(values) < 0:
        raise InputError.at(element.place, "n and k are not negative")
    context.findings.note(element.place, metals.FROM_RGB)
    return metals.part_of_rgb(values)


def _held(spectrum: Json) -> Json:
    """Of an index beyond its table nothing can be zero, so the ends hold."""
    return {"table": spectrum["table"]} if isinstance(spectrum, dict) and "table" in spectrum else spectrum


def _conductor(context: Context, properties: Properties) -> Bsdf:
    kernel = {"type": "conductor", "index": _metal(context, properties)}
    return Bsdf(front_only(_scaled_down(context, properties, kernel)))


def _rough_conductor(context: Context, properties: Properties) -> Bsdf:
    kernel = {"type": "conductor", "index": _metal(context, properties), **_roughness(context, properties)}
    return Bsdf(front_only(_scaled_down(context, properties, kernel)))


def _scaled_down(context: Context, properties: Properties, kernel: Json) -> Json:
    """`specular_reflectance`: the rest is black."""
    factor = textures.colour(context, properties, "specular_reflectance", 1.0)
    if isinstance(factor, dict) and "texture" not in factor:
        own = metals.colour_under(kernel["index"], 1.0)
        at = colours.knots(own, factor)
        colour = colours.table(at, colours.values_of(own, at) * colours.values_of(factor, at))
        context.findings.note(
            properties.place, "a metal times a colour became one of that colour at normal incidence"
        )
        return kernel | {"index": metals.of_colour(colour)}
    return kernel if factor == 1.0 else {"type": "blend", "first": BLACK, "second": kernel, "weight": factor}


def _plastic(context: Context, properties: Properties) -> Bsdf:
    index = _relative_index(context, properties, "polypropylene")
    return Bsdf(front_only(_coated(context, properties, index, smooth_coat(index))))


def _rough_plastic(context: Context, properties: Properties) -> Bsdf:
    index = _relative_index(context, properties, "polypropylene")
    roughness = _roughness(context, properties)
    coat = smooth_coat(index)
    if isinstance(roughness.get("roughness"), float):
        coat = rough_coat(index, roughness["roughness"], roughness.get("distribution", "ggx"))
        context.findings.note(
            properties.place,
            "what Mitsuba's rough coat loses between its facets, the base loses instead: as much in even "
            "light, and the same part at all angles",
        )
    else:
        context.findings.note(
            properties.place, "a coat of varying roughness loses none of the light that Mitsuba's loses"
        )
    return Bsdf(front_only(_coated(context, properties, index, coat) | roughness))


def _coated(context: Context, properties: Properties, index: float, coat: Coat) -> Json:
    _scales(context, properties, "specular_reflectance")
    base = textures.colour(context, properties, "diffuse_reflectance", 0.5)
    linear = not properties.switch("nonlinear", False)
    if not (isinstance(base, dict) and "texture" in base):
        base = base_under(coat, base, linear=linear)
    elif linear or coat != smooth_coat(index):
        # A smooth coat that saturates colours leaves them as they are.
        base = textures.changed(
            context, base, lambda pixels: coat.changed(pixels, linear=linear), properties.place
        )
    return {"type": "coated_diffuse", "index": index, "reflectance": base}


def _polarising_plastic(context: Context, properties: Properties) -> Bsdf:
    """Of its diffuse part light that the coat sends back inside is lost: T(wi) T(wo) R / pi."""
    index = _relative_index(context, properties, "polypropylene")
    coat = smooth_coat(index)
    # Ours is T(wi) T(wo) R' / (pi n^2 (1 - R' E)), so that R' / (1 - R' E) = n^2 R.
    coat = Coat(coat.inside, 1 - index**-2)
    roughness = _roughness(context, properties)
    context.findings.note(properties.place, "polarisation is left out")
    return Bsdf(front_only(_coated(context, properties, index, coat) | roughness))


def _coating(context: Context, properties: Properties) -> Bsdf:
    """A layer over another material: light that comes back from that goes out, or is lost.

    Source: bsdfs/coating.cpp and bsdfs/roughcoating.cpp of Mitsuba 0.6.
    """
    index = _relative_index(context, properties)
    rough = properties.element.type == "roughcoating"
    roughness = _roughness(context, properties) if rough else {}
    if not properties.has("sigma_a"):
        properties.ignore("thickness")
    _scales(context, properties, "specular_reflectance")
    [inside] = _inside(context, properties, 1, 1)
    base = front_of(inside.kernel)
    if base["type"] != "lambertian":
        context.findings.lost(
            properties.place, f'no support for a coating over "{base["type"]}", only over diffuse; left out'
        )
        return inside
    reflectance = base["reflectance"]
    # Ours is T(wi) T(wo) R' / (pi n^2 (1 - R' E)), theirs T(wi) T(wo) R / (pi n^2).
    coat = Coat(smooth_coat(index).inside, 0.0)
    if isinstance(reflectance, dict) and "texture" in reflectance:
        reflectance = textures.changed(
            context, reflectance, lambda pixels: coat.changed(pixels, linear=True), properties.place
        )
    else:
        reflectance = base_under(coat, reflectance, linear=True)
    kernel = {"type": "coated_diffuse", "index": index, "reflectance": reflectance, **roughness}
    return Bsdf(front_only(kernel), inside.normal_or_bump)


def _principled(context: Context, properties: Properties) -> Bsdf:
    kernel = principled(context, properties)
    # A blend has glass in it, the boundary of a body.
    return Bsdf(kernel if kernel["type"] in ("dielectric", "blend") else front_only(kernel))


def _inside(context: Context, properties: Properties, least: int, most: int) -> list[Bsdf]:
    inside = [bsdf(context, element) for element in properties.take_all("bsdf")]
    if not least <= len(inside) <= most:
        raise InputError.at(
            properties.place, f"expected {least} to {most} materials inside, found {len(inside)}"
        )
    return inside


def _two_sided(context: Context, properties: Properties) -> Bsdf:
    inside = _inside(context, properties, 1, 2)
    if len(inside) == 1:
        return Bsdf(front_of(inside[0].kernel), inside[0].normal_or_bump)
    front, back = (front_of(each.kernel) for each in inside)
    return Bsdf({"type": "two_sided", "front": front, "back": back}, inside[0].normal_or_bump)


def _mask(context: Context, properties: Properties) -> Bsdf:
    [inside] = _inside(context, properties, 1, 1)
    opacity = textures.number(context, properties, "opacity", 0.5)
    return Bsdf({"type": "mask", "kernel": inside.kernel, "opacity": opacity}, inside.normal_or_bump)


def _blend(context: Context, properties: Properties) -> Bsdf:
    first, second = _inside(context, properties, 2, 2)
    if first.normal_or_bump or second.normal_or_bump:
        context.findings.lost(properties.place, "no support for normal and bump maps inside a blend")
    weight = textures.number(context, properties, "weight", 0.5)
    return Bsdf({"type": "blend", "first": first.kernel, "second": second.kernel, "weight": weight})


def _null(context: Context, properties: Properties) -> Bsdf:
    del context, properties
    return Bsdf({"type": "null"})


def _polarizer(context: Context, properties: Properties) -> Bsdf:
    """Of light that is not polarised half goes on, less what the filter absorbs."""
    properties.ignore("theta", "polarizing")
    passing = properties.number("transmittance", 1.0) / 2
    context.findings.note(
        properties.place, "polarisation is left out: the filter lets half of the light through"
    )
    return Bsdf({"type": "mask", "kernel": BLACK, "opacity": 1 - passing})


def _ignore_rules_of_shading_normals(properties: Properties) -> None:
    """Take what Mitsuba does besides tilting normals; tests/mitsuba/README.md has the numbers."""
    properties.without_effect("no light is taken away for tilted normals", "use_shadowing_function")
    properties.without_effect(
        "from behind a shading normal the surface's own normal counts", "flip_invalid_normals"
    )


def _normal_map(context: Context, properties: Properties) -> Bsdf:
    _ignore_rules_of_shading_normals(properties)
    [inside] = _inside(context, properties, 1, 1)
    element = properties.take("normalmap")
    use = None if element is None else textures.texture(context, element)
    if isinstance(use, float):
        raise InputError.at(properties.place, "a normal map has three values")
    return Bsdf(inside.kernel, inside.normal_or_bump | ({} if use is None else {"normal_map": use}))


def _bump_map(context: Context, properties: Properties) -> Bsdf:
    _ignore_rules_of_shading_normals(properties)
    [inside] = _inside(context, properties, 1, 1)
    height = properties.number("scale", 1.0)
    found = [properties.take(name) for name in properties.names()]
    use = textures.texture(context, found[0]) if found and found[0] is not None else None
    # One height everywhere is none.
    if isinstance(use, dict):
        context.findings.note(
            properties.place,
            "heights of the bump map are taken as metres, not as parts of the surface's size",
        )
        return Bsdf(inside.kernel, inside.normal_or_bump | {"bump_map": use | {"height": height}})
    return inside


_BSDFS: dict[str, Callable[[Context, Properties], Bsdf]] = {
    "diffuse": _diffuse,
    "dielectric": _dielectric,
    "roughdielectric": _rough_dielectric,
    "thindielectric": _thin_dielectric,
    "conductor": _conductor,
    "roughconductor": _rough_conductor,
    "plastic": _plastic,
    "roughplastic": _rough_plastic,
    "pplastic": _polarising_plastic,
    "principled": _principled,
    "twosided": _two_sided,
    "mask": _mask,
    "blendbsdf": _blend,
    "null": _null,
    "polarizer": _polarizer,
    "normalmap": _normal_map,
    "bumpmap": _bump_map,
    # Of Mitsuba 0.x alone.
    "coating": _coating,
    "roughcoating": _coating,
    "phong": lambda context, properties: Bsdf(front_only(lobes.phong(context, properties))),
    "ward": lambda context, properties: Bsdf(front_only(lobes.ward(context, properties))),
    "difftrans": lambda context, properties: Bsdf(lobes.leaf(context, properties)),
}
