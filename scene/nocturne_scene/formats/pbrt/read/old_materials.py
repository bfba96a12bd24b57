"""Materials of pbrt-v3 that pbrt-v4 has nothing like, as kernels: a glossy part added to a diffuse one.

`pbrt --upgrade` makes coated diffuse surfaces of them, which reflect by Fresnel's equations whatever `Ks` is,
and silver of any mirror. Sources: the files of the same names below src/materials of pbrt-v3.
"""

import math

from nocturne_scene.formats.pbrt.read import spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameters
from nocturne_scene.formats.reading import colours, metals
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.spectra.published import SRGB_LUMINANCE

# RoughnessToAlpha in src/core/microfacet.h of pbrt-v3: of the logarithm of a roughness of 0.001 or more.
_ALPHA = (1.62142, 0.819955, 0.1734, 0.0171201, 0.000640711)


def alpha_of(roughness: float, *, remap: bool) -> float:
    """Alpha of microfacets from a roughness of pbrt-v3, at most 1; 0 is polished."""
    if not remap or roughness == 0:
        return min(roughness, 1.0)
    x = math.log(max(roughness, 1e-3))
    return min(1.0, sum(coefficient * x**power for power, coefficient in enumerate(_ALPHA)))


def plastic(context: Context, parameters: Parameters) -> Json:
    """Facets of a dielectric of index 1.5, times `Ks`, with a diffuse part."""
    diffuse, glossy = (spectra.reflectance(context, parameters, name, 0.25) for name in ("Kd", "Ks"))
    return _glossy(diffuse, glossy, _roughness(context, parameters, 0.1), 1.5)


def substrate(context: Context, parameters: Parameters) -> Json:
    """A. Ashikhmin and P. Shirley (2000): `Ks` is the reflectance at normal incidence."""
    diffuse, glossy = (spectra.reflectance(context, parameters, name, 0.5) for name in ("Kd", "Ks"))
    if glossy == 0.0:
        parameters.ignore("roughness", "uroughness", "vroughness", "remaproughness")
        return {"type": "lambertian", "reflectance": diffuse}
    return {
        "type": "principled",
        "base": diffuse,
        "specular_colour": glossy,
        **_roughness(context, parameters, 0.1),
    }


def uber(context: Context, parameters: Parameters) -> Json:
    """A diffuse and a glossy part as plastic's, a mirror and glass of one index, and holes."""
    diffuse, glossy = (spectra.reflectance(context, parameters, name, 0.25) for name in ("Kd", "Ks"))
    mirror, clear = (spectra.reflectance(context, parameters, name, 0.0) for name in ("Kr", "Kt"))
    opacity = spectra.reflectance(context, parameters, "opacity", 1.0)
    index = spectra.index(context, parameters, "eta", 1.5)
    roughness = _roughness(context, parameters, 0.1)
    kernel = _glossy(diffuse, glossy, roughness, index)
    if mirror != 0.0:
        if kernel["type"] == "lambertian":
            kernel = {"type": "principled", "base": diffuse, "specular": 0.0}
        coat_index = index if isinstance(index, float) else 1.5
        kernel |= {"coat": _number(context, mirror, "Kr", parameters), "coat_index": coat_index}
    if clear != 0.0:
        weight = _number(context, clear, "Kt", parameters)
        kernel = _blend(kernel, {"type": "dielectric", "index": index}, weight)
    if opacity != 1.0:
        part = _number(context, opacity, "opacity", parameters)
        kernel = {"type": "mask", "kernel": kernel, "opacity": part}
    return kernel


def mirror(context: Context, parameters: Parameters) -> Json:
    """Reflects `Kr` at all angles; a metal that reflects it at normal incidence."""
    colour = spectra.reflectance(context, parameters, "Kr", 0.9)
    if isinstance(colour, dict) and "texture" in colour:
        context.findings.lost(parameters.place, "no support for a mirror that varies; taken as 0.9")
        colour = 0.9
    return {"type": "conductor", "index": metals.of_colour(colour)}


def translucent(context: Context, parameters: Parameters) -> Json:
    """A reflectance and a transmittance, both times `Kd`."""
    diffuse, glossy = (spectra.reflectance(context, parameters, name, 0.25) for name in ("Kd", "Ks"))
    parts = [spectra.reflectance(context, parameters, name, 0.5) for name in ("reflect", "transmit")]
    parameters.ignore("roughness", "remaproughness")
    if glossy != 0.0:
        context.findings.lost(parameters.place, 'no support for the "Ks" of a translucent surface')
    reflected, passing = (_product(context, diffuse, part, parameters) for part in parts)
    return {"type": "diffuse_transmitter", "reflectance": reflected, "transmittance": passing}


def disney(context: Context, parameters: Parameters) -> Json:
    """B. Burley (2012, 2015)."""
    base = spectra.reflectance(context, parameters, "color", 0.5)
    metallic = _plain(spectra.scalar(context, parameters, "metallic", 0.0))
    index = spectra.index(context, parameters, "eta", 1.5)
    rough = _plain(spectra.scalar(context, parameters, "roughness", 0.5))
    parameters.ignore("remaproughness")
    kernel: Json = {
        "type": "principled",
        "base": base,
        "metallic": metallic,
        "index": index,
        "roughness": rough,
    }
    turned = spectra.scalar(context, parameters, "anisotropic", 0.0)
    if isinstance(turned, float) and turned > 0 and isinstance(rough, float):
        # alpha is roughness^2 over, or times, the root of 1 - 0.9 anisotropic.
        aspect = (1 - 0.9 * turned) ** 0.25
        kernel |= {"roughness": min(1.0, rough / aspect), "roughness_across": rough * aspect}
    coat = spectra.scalar(context, parameters, "clearcoat", 0.0)
    gloss = spectra.scalar(context, parameters, "clearcoatgloss", 1.0)
    if coat != 0.0:
        alpha = 0.1 + (0.001 - 0.1) * (gloss if isinstance(gloss, float) else 1.0)
        kernel |= {
            "coat": coat / 4 if isinstance(coat, float) else 0.25,
            "coat_roughness": math.sqrt(alpha),
        }
    for name in ("sheen", "speculartint", "flatness"):
        if spectra.scalar(context, parameters, name, 0.0) != 0.0:
            context.findings.lost(parameters.place, f'no support for the "{name}" of disney')
    parameters.ignore("sheentint", "difftrans", "scatterdistance", "thin")
    through = spectra.scalar(context, parameters, "spectrans", 0.0)
    if through == 0.0:
        return kernel
    alpha = rough**2 if isinstance(rough, float) else 0.25
    glass: Json = {"type": "dielectric", "index": index, **({"roughness": alpha} if alpha else {})}
    return _blend(kernel, glass, _plain(through))


def _blend(first: Json, second: Json, weight: Json) -> Json:
    return second if weight == 1.0 else {"type": "blend", "first": first, "second": second, "weight": weight}


def opaque(context: Context, parameters: Parameters) -> Json:
    """Of kdsubsurface the surface, as if all light came back where it went in."""
    context.findings.lost(parameters.place, "no support for kdsubsurface; taken as an opaque surface")
    base = spectra.reflectance(context, parameters, "Kd", 0.5)
    index = spectra.index(context, parameters, "eta", 1.3)
    parameters.ignore_all()
    return {"type": "coated_diffuse", "index": index, "reflectance": base}


def _glossy(diffuse: Json, glossy: Json, roughness: Json, index: Json) -> Json:
    if glossy == 0.0:
        return {"type": "lambertian", "reflectance": diffuse}
    kernel: Json = {"type": "principled", "base": diffuse, "index": index, **roughness}
    if isinstance(glossy, dict) and "texture" not in glossy:
        # At normal incidence, before the factor.
        bright = spectra.largest(glossy)
        at_normal = ((index - 1) / (index + 1)) ** 2 if isinstance(index, float) else 0.04
        kernel["specular_colour"] = spectra.reflectance_times(glossy, at_normal / bright)
        glossy = bright
    return kernel | {"specular": _plain(glossy)}


def _roughness(context: Context, parameters: Parameters, default: float) -> Json:
    """Of a principled kernel, whose alpha is its square."""
    remap = parameters.switch("remaproughness", True)
    both = spectra.scalar(context, parameters, "roughness", default)
    along, across = (
        _root(context, parameters, spectra.scalar(context, parameters, f"{axis}roughness", both), remap)
        for axis in "uv"
    )
    return {"roughness": along} | ({} if along == across else {"roughness_across": across})


def _root(context: Context, parameters: Parameters, value: Json, remap: bool) -> Json:
    if isinstance(value, float):
        return math.sqrt(alpha_of(value, remap=remap))
    context.findings.lost(parameters.place, "a texture of remapped roughness is not supported")
    return _plain(value)


def _plain(value: Json) -> Json:
    """A number that varies, of a texture that may be a colour's."""
    if not isinstance(value, dict) or "texture" not in value:
        return value
    value = dict(value)
    factor = value.pop("spectrum", 1.0)
    return value | {"gain": factor} if factor != 1.0 else value


def _number(context: Context, value: Json, name: str, parameters: Parameters) -> Json:
    """A factor that is grey."""
    if isinstance(value, float) or "texture" in value:
        return _plain(value)
    context.findings.lost(
        parameters.place, f'no support for a coloured "{name}" of uber; taken as its brightness'
    )
    rgb = value.get("rgb")
    return sum(a * b for a, b in zip(SRGB_LUMINANCE, rgb, strict=True)) if rgb else spectra.largest(value)


def _product(context: Context, first: Json, second: Json, parameters: Parameters) -> Json:
    if isinstance(first, float) and not isinstance(second, float):
        first, second = second, first
    if isinstance(second, float):
        return spectra.reflectance_times(first, second)
    if "rgb" in first and "rgb" in second:
        return colours.reflectance([a * b for a, b in zip(first["rgb"], second["rgb"], strict=True)])
    context.findings.lost(parameters.place, "no support for the product of two colours that vary")
    return first
