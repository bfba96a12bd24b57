"""Directives of pbrt-v3 in the words of pbrt-v4, so that its readers need no others.

Files of pbrt-v3 say no version. Each directive is known by what only pbrt-v3 has, and changed by a rule that
names its source: "v4" is FormattingParserTarget in src/pbrt/parser.cpp of pbrt-v4 (`pbrt --upgrade`), all
else a file of pbrt-v3 below src. Where both disagree pbrt-v3 counts, as its image is the one that was meant.
Materials that pbrt-v4 has nothing like are in old_materials.py.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read import spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.old_materials import alpha_of
from nocturne_scene.formats.pbrt.read.parameters import Parameter
from nocturne_scene.formats.reading import colours
from nocturne_scene.spectra.published import XYZ_TO_SRGB, planck

# Materials that only pbrt-v3 has: materials/*.cpp.
OLD_MATERIALS = frozenset(
    (
        "disney",
        "fourier",
        "glass",
        "kdsubsurface",
        "matte",
        "metal",
        "mirror",
        "plastic",
        "substrate",
        "translucent",
        "uber",
    )
)
_SCATTERED = ("Kd", "Ks", "Kr", "Kt", "reflect", "transmit", "opacity", "color")
# What named tables of metals are called in pbrt-v3's scenes, and in pbrt-v4.
_METAL_FILE = re.compile(r"(?:.*/)?(Ag|Al|Au|Cu)\.(eta|k)\.spd")

_WIEN = 2.8977721e6
"""Wavelength of the most radiance times temperature, nm kelvin."""


@dataclass
class Given:
    """A directive that is being upgraded."""

    context: Context
    kind: str
    parameters: list[Parameter]
    place: str

    def find(self, name: str) -> Parameter | None:
        """Return a parameter."""
        return next((each for each in self.parameters if each.name == name), None)

    def take(self, name: str) -> Parameter | None:
        """Return a parameter and remove it."""
        found = self.find(name)
        if found is not None:
            self.parameters.remove(found)
        return found

    def drop(self, *names: str) -> None:
        """Remove parameters that don't change what an image converges to."""
        self.parameters = [each for each in self.parameters if each.name not in names]

    def rename(self, **names: str) -> None:
        """Give parameters their new names."""
        self.parameters = [
            replace(each, name=names[each.name]) if each.name in names else each for each in self.parameters
        ]

    def set(self, kind: str, name: str, *values: float | str) -> None:
        """Add a parameter, in place of one of that name."""
        self.take(name)
        self.parameters.append(Parameter(kind, name, list(values), self.place))  # type: ignore[arg-type]

    def note(self, message: str) -> None:
        """Note a different form, once."""
        self.context.findings.note("", message)

    def lose(self, message: str) -> None:
        """Report a part without a counterpart."""
        self.context.findings.lost(self.place, message)


def upgrade(
    context: Context, target: str, kind: str, parameters: list[Parameter], place: str
) -> tuple[str, list[Parameter]]:
    """Return a plugin's name and its parameters as pbrt-v4 calls them."""
    given = Given(context, kind, parameters, place)
    with context.findings.leaving_out():
        given.parameters = [_value(each) for each in parameters]
        if target in _RULES:
            _RULES[target](given)
    return given.kind, given.parameters


def _value(found: Parameter) -> Parameter:
    """core/parser.cpp: `color` is rgb; xyz is converted to it."""
    if found.type == "color":
        return replace(found, type="rgb")
    if found.type == "xyz":
        xyz = found.numbers(3)
        rgb = [sum(a * b for a, b in zip(row, xyz, strict=True)) for row in XYZ_TO_SRGB.tolist()]
        return replace(found, type="rgb", values=[max(each, 0.0) for each in rgb])
    if found.type == "spectrum" and found.values and isinstance(found.values[0], str):
        match = _METAL_FILE.fullmatch(found.values[0])
        if match is not None:
            return replace(found, values=[f"metal-{match[1]}-{match[2]}"])
    return found


def _material(given: Given) -> None:
    """v4: upgradeMaterial."""
    given.rename(bumpmap="displacement")
    if given.kind == "mix" and given.find("namedmaterial1") is not None:
        _mix(given)
    if given.kind not in OLD_MATERIALS:
        return
    given.context.is_old = True
    given.rename(index="eta")
    given.parameters = [_held(given, each) for each in given.parameters]
    match given.kind:
        case "matte":
            given.kind = "diffuse"
            given.rename(Kd="reflectance")
            if (sigma := given.take("sigma")) is not None and sigma.values != [0.0]:
                given.note("matte with a sigma became diffuse of the same reflectance")
        case "glass":
            given.kind = "dielectric"
            _clear(given)
            _rough(given, 0.0)
        case "metal":
            given.kind = "conductor"
            _rough(given, 0.01)


def _held(given: Given, found: Parameter) -> Parameter:
    """Lambertian reflection of more than all light: pbrt-v4 refuses it, and so do we."""
    if found.name in _SCATTERED and found.type == "rgb" and max(found.numbers(3)) > 1:
        given.context.findings.note(found.place, f'"{found.name}" above 1 was taken as 1')
        return replace(found, values=[min(each, 1.0) for each in found.numbers(3)])
    return found


def _clear(given: Given) -> None:
    """Factors of what glass reflects and lets through: only 1 is supported."""
    for name in ("Kr", "Kt"):
        found = given.take(name)
        if found is not None and (found.type == "texture" or any(each != 1.0 for each in found.numbers())):
            given.lose(f'no support for a "{name}" other than 1 of glass')


def _rough(given: Given, default: float) -> None:
    """materials/glass.cpp, materials/metal.cpp: another curve than pbrt-v4's square root."""
    remap = given.find("remaproughness")
    is_remapped = remap is None or remap.word().lower() == "true"
    names = [name for name in ("roughness", "uroughness", "vroughness") if given.find(name) is not None]
    if not names:
        given.set("float", "roughness", default)
        names = ["roughness"]
    alphas: dict[str, float] = {}
    for name in names:
        value = number_of(given.context, given.find(name))
        if value is None:
            return  # a texture: the reader reports that it is not supported where it is remapped
        alphas[name] = alpha_of(value, remap=is_remapped)
    for name, alpha in alphas.items():
        given.set("float", name, alpha)
    given.set("bool", "remaproughness", "false")


def number_of(context: Context, found: Parameter | None) -> float | None:
    """A number, also of a texture that is the same everywhere; None of one that varies."""
    if found is None:
        return None
    if found.type != "texture":
        return found.numbers(1)[0]
    value = spectra.texture(context, found, "float")
    return value if isinstance(value, float) else None


def _mix(given: Given) -> None:
    """v4: the other way round, and by a number."""
    names = [given.take(f"namedmaterial{number}") for number in (2, 1)]
    if any(name is None for name in names):
        raise InputError.at(given.place, 'a mix needs "namedmaterial1" and "namedmaterial2"')
    given.set("string", "materials", *(name.word() for name in names if name is not None))
    amount = given.find("amount")
    if amount is not None and amount.type == "rgb":
        values = amount.numbers(3)
        if len(set(values)) > 1:
            given.note('the "amount" of a mix is the mean of its colour')
        given.set("float", "amount", values[0] if len(set(values)) == 1 else sum(values) / 3)


def _light(given: Given) -> None:
    """lights/*.cpp. v4: LightSource."""
    given.drop("samples", "nsamples")
    main = "I" if given.find("I") is not None or given.kind in ("point", "spot") else "L"
    _scale(given, main)
    name = given.find("mapname")
    if name is None or name.values == [""]:
        given.drop("mapname")
        return
    given.context.is_old = True
    given.rename(mapname="filename")
    given.set("string", "mapping", "equirectangular")
    tint = given.take(main)
    if tint is not None:
        values = tint.numbers(3) if tint.type == "rgb" else [1.0, 0.0, 0.0]
        if len(set(values)) > 1:
            given.lose(f'no support for a coloured "{main}" beside a picture; taken as white')
        elif tint.type == "rgb":
            _multiply(given, values[0])


def _scale(given: Given, main: str) -> None:
    """A colour `scale`, and lights by spectra: theirs is the absolute value, pbrt-v4's the luminance."""
    scale, light = given.find("scale"), given.find(main)
    if scale is not None and scale.type == "rgb":
        given.context.is_old = True
        values = scale.numbers(3)
        if len(set(values)) == 1:
            given.set("float", "scale", values[0])
        elif light is None or light.type == "rgb":
            given.take("scale")
            white = [1.0] * 3 if light is None else light.numbers(3)
            given.set("rgb", main, *(a * b for a, b in zip(values, white, strict=True)))
        else:
            given.lose('no support for a coloured "scale" beside a spectrum; taken as its mean')
            given.set("float", "scale", sum(values) / 3)
    if light is not None and light.type == "blackbody" and len(light.values) == 2:
        given.context.is_old = True
        kelvin, factor = light.numbers(2)
        given.set("blackbody", main, kelvin)
        _multiply(given, factor * _luminance_of_black_body(light, kelvin))
    elif light is not None and light.type == "spectrum" and given.context.is_old:
        table = spectra.spectrum(given.context, light) | {"outside": "zero"}
        _multiply(given, colours.luminance_of(table) / colours.luminance_of(1.0))


def _luminance_of_black_body(found: Parameter, kelvin: float) -> float:
    """BlackbodyNormalized in core/spectrum.cpp: of a radiance whose largest is 1, over that of an even 1."""
    if not 100 <= kelvin <= 1e6:
        raise InputError.at(found.place, f"expected a temperature of 100 to 1000000 K, found {kelvin:g}")

    most = planck(kelvin, np.array([_WIEN / kelvin]))
    table = colours.table(colours.SMOOTH, planck(kelvin, colours.SMOOTH) / most)
    return colours.luminance_of(table) / colours.luminance_of(1.0)


def _multiply(given: Given, factor: float) -> None:
    if factor != 1.0:
        scale = given.find("scale")
        given.set("float", "scale", factor * (1.0 if scale is None else scale.numbers(1)[0]))


def _area_light(given: Given) -> None:
    """v4: AreaLightSource."""
    if given.kind == "area":
        given.kind = "diffuse"
    _light(given)


def _texture(given: Given) -> None:
    """v4: Texture. textures/imagemap.cpp, textures/scale.cpp."""
    given.drop("aamode", "trilinear")
    if given.kind == "scale":
        given.rename(tex1="tex", tex2="scale")
    if (gamma := given.take("gamma")) is not None:
        is_number = gamma.type == "float"
        given.set("string", "encoding", f"gamma {gamma.numbers(1)[0]!r}" if is_number else _curve(gamma))


def _curve(gamma: Parameter) -> str:
    return "sRGB" if gamma.word().lower() == "true" else "linear"


def _shape(given: Given) -> None:
    """v4: Shape, upgradeTriMeshUVs."""
    given.drop("discarddegenerateUVs", "shadowalpha")
    if given.kind == "loopsubdiv":
        given.rename(nlevels="levels")
    if given.find("uv") is None:
        given.rename(st="uv")
    uv = given.find("uv")
    if uv is not None and uv.type == "float":
        given.set("point2", "uv", *uv.numbers())


def _film(given: Given) -> None:
    """v4: Film."""
    if given.kind == "image":
        given.context.is_old = True
        given.kind = "rgb"
    given.rename(scale="iso", maxsampleluminance="maxcomponentvalue")


def _integrator(given: Given) -> None:
    """v4: Integrator. Some names and how one samples is all that differs."""
    given.drop("rrthreshold", "lightsamplestrategy", "imagewritefrequency", "numiterations")


def _medium(given: Given) -> None:
    """v4: MakeNamedMedium; core/api.cpp: coefficients that pbrt-v4's grids don't have by default."""
    kind = given.find("type")
    if kind is not None and kind.values == ["heterogeneous"]:
        given.set("string", "type", "uniformgrid")
        if given.find("preset") is None:
            for name, values in (("sigma_a", (0.0011, 0.0024, 0.014)), ("sigma_s", (2.55, 3.21, 3.77))):
                if given.find(name) is None:
                    given.set("rgb", name, *values)


def _camera(given: Given) -> None:
    """cameras/*.cpp: nothing is clipped here."""
    given.drop("hither", "yon", "simpleweighting")


_RULES: dict[str, Callable[[Given], None]] = {
    "area light": _area_light,
    "camera": _camera,
    "film": _film,
    "integrator": _integrator,
    "light": _light,
    "material": _material,
    "medium": _medium,
    "shape": _shape,
    "texture": _texture,
}
