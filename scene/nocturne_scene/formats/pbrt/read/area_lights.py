"""Area lights of pbrt's, on shapes that may have holes."""

from nocturne_scene.formats.pbrt.read import spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameters
from nocturne_scene.formats.reading import colours, lamps
from nocturne_scene.formats.reading.scene_writer import Json


def opacity(context: Context, parameters: Parameters) -> Json:
    """A shape's `alpha`: a number from 0 to 1, or a use of a texture."""
    found = spectra.scalar(context, parameters, "alpha", 1.0)
    return min(max(float(found), 0.0), 1.0) if isinstance(found, float | int) else found


def luminaire(context: Context, kernel: Json, opacity: Json) -> Json | None:
    """What a shape of a kernel and an opacity has of the `AreaLightSource` of now; None without one.

    What is cut out does not shine. A shape of which nothing is there lights all the same, and no ray meets
    it: DiffuseAreaLight in lights.cpp of pbrt-v4.
    """
    if context.state.area_light is None:
        return None
    if kernel == {"type": "null"}:
        place = context.state.area_light[2]
        context.findings.note(place, 'no light on shapes of an "interface" material, as in pbrt')
        return None
    found = _whole(context)
    if opacity == 0.0:
        return found | {"hidden_from": lamps.UNSEEN}
    if isinstance(opacity, float):
        return found | {"radiance": colours.scaled(found["radiance"], opacity)}
    spectrum = colours.scaled(found["radiance"], opacity.get("gain", 1.0))
    use = {key: value for key, value in opacity.items() if key != "gain"}
    return found | {"radiance": {**use, "grey": True, "spectrum": spectrum}}


def _whole(context: Context) -> Json:
    if context.state.area_light is None:
        raise ValueError("there is no area light")
    kind, given, place = context.state.area_light
    parameters = context.parameters("area light", place, given)
    if kind != "diffuse":
        context.findings.lost(place, f'no equal of the area light "{kind}"; there is diffuse')
    if parameters.take("filename") is not None:
        context.findings.lost(place, 'no equal of an area light\'s "filename"')
    if parameters.take("power") is not None:
        context.findings.lost(
            place, 'no equal of an area light\'s "power": each triangle has all of it in pbrt'
        )
    radiance = spectra.light(context, parameters, "L", float(parameters.number("scale", 1.0)))
    two_sided = parameters.switch("twosided", False)
    parameters.finish()
    return {"radiance": radiance} | ({"two_sided": True} if two_sided else {})
