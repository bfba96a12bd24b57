"""Materials of pbrt's as kernels. Theirs, as ours, scatter on both sides of a surface."""

import math
from collections.abc import Callable

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read import spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameter, Parameters
from nocturne_scene.formats.reading import metals
from nocturne_scene.formats.reading.scene_writer import Json


def material(context: Context, kind: str, parameters: Parameters) -> tuple[Json, Json]:
    """Return a kernel, and the fields of a surface that change its shading normal."""
    if kind not in _MATERIALS:
        context.findings.lost(
            parameters.place,
            f'no equal of the material "{kind}"; there are {", ".join(_MATERIALS)}. Taken as grey',
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
        found = spectra.texture(context, heights) if heights.type == "texture" else {}
        if "texture" in found:
            height = found.pop("spectrum", 1.0) if "spectrum" in (found := dict(found)) else 1.0
            normal_or_bump["bump_map"] = found | {"height": height}
    return normal_or_bump


def _roughness(context: Context, parameters: Parameters, default: float) -> Json:
    """pbrt's roughness is the square of alpha, unless it says otherwise."""
    remap = parameters.switch("remaproughness", True)
    both = spectra.scalar(context, parameters, "roughness", default)
    values = [spectra.scalar(context, parameters, f"{axis}roughness", both) for axis in "uv"]
    alphas = []
    for value in values:
        if not isinstance(value, float):
            if remap:
                context.findings.lost(parameters.place, "a texture of remapped roughness has no equal")
            alphas.append(value)
        elif not 0 <= value <= 1:
            raise InputError.at(parameters.place, f"a roughness lies between 0 and 1, found {value:g}")
        else:
            alphas.append(math.sqrt(value) if remap else value)
    if alphas[0] == alphas[1]:
        return {} if alphas[0] == 0.0 else {"roughness": alphas[0]}
    return {"roughness_u": alphas[0], "roughness_v": alphas[1]}


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
        context.findings.lost(parameters.place, "a coat that scatters has no equal")
    return {
        "type": "coated_diffuse",
        "index": spectra.index(context, parameters, "eta", 1.5),
        "reflectance": spectra.reflectance(context, parameters, "reflectance", 0.5),
        **_roughness(context, parameters, 0.0),
    }


def _coated_conductor(context: Context, parameters: Parameters) -> Json:
    """The metal alone."""
    context.findings.lost(parameters.place, "no equal of a coat over metal; the metal is taken without it")
    coat = (
        "roughness",
        "uroughness",
        "vroughness",
        "eta",
        "thickness",
        "maxdepth",
        "nsamples",
        "g",
        "albedo",
    )
    parameters.ignore(*(f"interface.{name}" for name in coat), *coat)
    return _metal(context, parameters, "conductor.")


def _conductor(context: Context, parameters: Parameters) -> Json:
    return _metal(context, parameters, "")


def _metal(context: Context, parameters: Parameters, prefix: str) -> Json:
    """A metal whose parameters begin with a prefix."""
    parameters.rename(prefix)
    roughness = _roughness(context, parameters, 0.0)
    reflectance = parameters.take("reflectance")
    if reflectance is not None:
        values = reflectance.numbers(1, 3)
        if len(set(values)) > 1:
            context.findings.lost(
                parameters.place, "a metal's coloured reflectance has no equal; its mean is taken"
            )
        r = min(sum(values) / len(values), 0.9999)
        # At normal incidence with n = 1: r = k^2 / (4 + k^2).
        index: Json = {"n": 1.0, "k": 2 * math.sqrt(r / (1 - r))}
    else:
        eta, k = parameters.take("eta"), parameters.take("k")
        named = "metal-Cu-eta" if eta is None else str(eta.values[0])
        if named in spectra.METALS:
            index = spectra.METALS[named]
        elif eta is None or k is None:
            raise InputError.at(parameters.place, "a conductor needs eta and k, or reflectance")
        else:
            index = {name: _part(context, each) for name, each in (("n", eta), ("k", k))}
    return {"type": "conductor", "index": index, **roughness}


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
}
