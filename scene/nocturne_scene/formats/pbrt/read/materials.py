"""Materials of pbrt's as kernels. Theirs, as ours, scatter on both sides of a surface."""

import math
from collections.abc import Callable

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read import old_materials, spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameter, Parameters
from nocturne_scene.formats.reading import colours, metals
from nocturne_scene.formats.reading.scene_writer import Json


def material(context: Context, kind: str, parameters: Parameters) -> tuple[Json, Json]:
    """Return a kernel, and the fields of a surface that change its shading normal."""
    if kind not in _MATERIALS:
        known = ", ".join(filter(None, _MATERIALS))
        context.findings.lost(
            parameters.place, f'no support for the material "{kind}"; there are {known}. Taken as grey'
        )
        return {"type": "lambertian", "reflectance": 0.5}, {}
    kernel = _MATERIALS[kind](context, parameters)
    normal_or_bump = _normal_or_bump(context, parameters)
    parameters.finish()
    return kernel, normal_or_bump


def _normal_or_bump(context: Context, parameters: Parameters) -> Json:
    normal_or_bump: Json = {}
    normals = parameters.word("normalmap", None)
    if normals is not None:
        asset = context.writer.copy(context.file(normals, parameters.place))
        normal_or_bump["normal_map"] = {"texture": {"asset": asset, "encoding": "linear"}}
    heights = parameters.take("displacement")
    if heights is not None:
        found = spectra.texture(context, heights, "float") if heights.type == "texture" else {}
        # One height everywhere changes nothing.
        if isinstance(found, dict) and "texture" in found:
            found = dict(found)
            height = found.pop("gain", 1.0)
            normal_or_bump["bump_map"] = found | {"height": height}
    return normal_or_bump


def _roughness(context: Context, parameters: Parameters, default: float) -> Json:
    """pbrt's roughness is the square of alpha, unless it says otherwise."""
    alphas = _alphas(context, parameters, default, parameters.switch("remaproughness", True))
    if alphas[0] == alphas[1]:
        return {} if alphas[0] == 0.0 else {"roughness": alphas[0]}
    return {"roughness_u": alphas[0], "roughness_v": alphas[1]}


def _alphas(context: Context, parameters: Parameters, default: float, remap: bool) -> list[Json]:
    """Along u and along v."""
    both = spectra.scalar(context, parameters, "roughness", default)
    values = [spectra.scalar(context, parameters, f"{axis}roughness", both) for axis in "uv"]
    alphas: list[Json] = []
    for value in values:
        if not isinstance(value, float):
            if remap:
                context.findings.lost(parameters.place, "a texture of remapped roughness is not supported")
            alphas.append(value)
        elif not 0 <= value <= 1:
            raise InputError.at(parameters.place, f"a roughness lies between 0 and 1, found {value:g}")
        else:
            alphas.append(math.sqrt(value) if remap else value)
    return alphas


def _diffuse(context: Context, parameters: Parameters) -> Json:
    return {
        "type": "lambertian",
        "reflectance": spectra.reflectance(context, parameters, "reflectance", 0.5),
    }


def _diffuse_transmission(context: Context, parameters: Parameters) -> Json:
    scale = float(parameters.number("scale", 1.0))
    parts = [
        spectra.reflectance(context, parameters, name, 0.25) for name in ("reflectance", "transmittance")
    ]
    # Of pictures it is not known how much light they reflect: the scene's maker has seen to it.
    most = (
        sum(spectra.largest(each) for each in parts)
        if all("texture" not in str(each) for each in parts)
        else 1.0
    )
    if scale * most > 1 + 1e-6:
        context.findings.lost(
            parameters.place, "it sends back and lets through more light than comes; made as much darker"
        )
        scale = 1 / most
    reflectance, transmittance = (spectra.reflectance_times(each, scale) for each in parts)
    return {"type": "diffuse_transmitter", "reflectance": reflectance, "transmittance": transmittance}


def _coated_diffuse(context: Context, parameters: Parameters) -> Json:
    context.findings.note(
        parameters.place,
        "coateddiffuse became a thin clear coat over the base, in closed form instead of random walks",
    )
    parameters.ignore("thickness", "maxdepth", "nsamples", "g")
    if spectra.reflectance(context, parameters, "albedo", 0.0) != 0.0:
        context.findings.lost(parameters.place, "a coat that scatters is not supported")
    return {
        "type": "coated_diffuse",
        "index": spectra.index(context, parameters, "eta", 1.5),
        "reflectance": spectra.reflectance(context, parameters, "reflectance", 0.5),
        **_roughness(context, parameters, 0.0),
    }


def _coated_conductor(context: Context, parameters: Parameters) -> Json:
    """Metal under a coat, whose index makes it reflect less."""
    context.findings.note(
        parameters.place,
        "coatedconductor became metal under a thin clear coat, in closed form instead of random walks",
    )
    parameters.ignore("thickness", "maxdepth", "nsamples", "g")
    if spectra.reflectance(context, parameters, "albedo", 0.0) != 0.0:
        context.findings.lost(parameters.place, "a coat that scatters is not supported")
    remap = parameters.switch("remaproughness", True)
    parameters.rename("conductor.")
    given = {name: parameters.take(name) for name in ("reflectance", "eta", "k")}
    below = _alphas(context, parameters, 0.0, remap)
    parameters.rename("interface.")
    coat, index = _alphas(context, parameters, 0.0, remap)[0], parameters.number("eta", 1.5)
    if not 1 <= index <= 4:
        raise InputError.at(parameters.place, f"a coat's index lies between 1 and 4, found {index:g}")
    if given["reflectance"] is not None:
        rgb = given["reflectance"].numbers(1, 3)
        base = colours.reflectance(rgb if len(rgb) == 3 else rgb * 3)
    else:
        base = metals.colour_under(_index(context, parameters.place, given["eta"], given["k"]), index)
    along, across = (_root(context, parameters.place, each) for each in below)
    return {
        "type": "principled",
        "base": base,
        "metallic": 1.0,
        "roughness": along,
        **({} if along == across else {"roughness_across": across}),
        "coat": 1.0,
        "coat_roughness": _root(context, parameters.place, coat),
        "coat_index": index,
    }


def _root(context: Context, place: str, alpha: Json) -> Json:
    """The roughness of a principled kernel, whose square is alpha."""
    if isinstance(alpha, float):
        return math.sqrt(alpha)
    context.findings.lost(place, "no support for the root of a texture of roughness; taken as it is")
    return alpha


def _conductor(context: Context, parameters: Parameters) -> Json:
    roughness = _roughness(context, parameters, 0.0)
    reflectance = parameters.take("reflectance")
    if reflectance is not None:
        values = reflectance.numbers(1, 3)
        # At normal incidence with n = 1, as in pbrt.
        index = metals.of_colour(colours.reflectance(values if len(values) == 3 else values * 3))
    else:
        index = _index(context, parameters.place, parameters.take("eta"), parameters.take("k"))
    return {"type": "conductor", "index": index, **roughness}


def _index(context: Context, place: str, eta: Parameter | None, k: Parameter | None) -> Json:
    named = "metal-Cu-eta" if eta is None else str(eta.values[0])
    if named in spectra.METALS:
        return spectra.METALS[named]
    if eta is None or k is None:
        raise InputError.at(place, "a conductor needs eta and k, or reflectance")
    return {name: _part(context, each) for name, each in (("n", eta), ("k", k))}


def _part(context: Context, found: Parameter) -> Json:
    """n or k."""
    match found.type:
        case "float":
            return found.numbers(1)[0]
        case "rgb":
            values = found.numbers(3)
            if min(values) < 0:
                raise InputError.at(found.place, "n and k are not negative")
            context.findings.note(found.place, metals.FROM_RGB)
            return metals.part_of_rgb(values)
    return spectra.spectrum(context, found)


def _dielectric(context: Context, parameters: Parameters) -> Json:
    return {
        "type": "dielectric",
        "index": spectra.index(context, parameters, "eta", 1.5),
        **_roughness(context, parameters, 0.0),
    }


def _thin_dielectric(context: Context, parameters: Parameters) -> Json:
    return {"type": "thin_pane", "index": spectra.index(context, parameters, "eta", 1.5)}


def _interface(context: Context, parameters: Parameters) -> Json:
    del context, parameters
    return {"type": "null"}


def _mix(context: Context, parameters: Parameters) -> Json:
    names = parameters.take("materials")
    if names is None or len(names.values) != 2:
        raise InputError.at(parameters.place, 'a mix needs two "materials"')
    for name in names.values:
        if name not in context.materials:
            raise InputError.at(names.place, f'no material "{str(name)[:80]}"')
    first, second = (context.materials[str(name)][0] for name in names.values)
    weight = spectra.scalar(context, parameters, "amount", 0.5)
    return {"type": "blend", "first": first, "second": second, "weight": weight}


_MATERIALS: dict[str, Callable[[Context, Parameters], Json]] = {
    "diffuse": _diffuse,
    "diffusetransmission": _diffuse_transmission,
    "coateddiffuse": _coated_diffuse,
    "coatedconductor": _coated_conductor,
    "conductor": _conductor,
    "dielectric": _dielectric,
    "thindielectric": _thin_dielectric,
    "interface": _interface,
    "": _interface,
    "none": _interface,
    "mix": _mix,
    # Of pbrt-v3 alone.
    "plastic": old_materials.plastic,
    "substrate": old_materials.substrate,
    "uber": old_materials.uber,
    "mirror": old_materials.mirror,
    "translucent": old_materials.translucent,
    "disney": old_materials.disney,
    "kdsubsurface": old_materials.opaque,
}
