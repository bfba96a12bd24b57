"""Stokes vectors: filters, glass, metal, piles of plates, Fresnel's rhomb, molecules, air.

Signs are those of docs/explanation/polarisation.md. A negative truth is told with the sign turned.
"""

import cmath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import cos, pi, radians, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.validation.cases import Quantity, Scene, Value
from nocturne_scene.validation.documents import BLACK, GREY, Document, box, diffuse, quad, slab, sun
from nocturne_scene.validation.truths import truths

_MALUS = "Malus's law"
_FRESNEL = "Fresnel's amplitudes (M. Born and E. Wolf, Principles of Optics, 7th ed., sections 1.5 and 14.2)"
_RHOMB = (
    "Born and Wolf, section 1.5.4: Fresnel's rhomb, index 1.51, 45.80 degrees a reflection at 50.229 degrees"
)
_PILE = "G. G. Stokes, Proc. Royal Society 11, 1862: (1 - R) / (1 + (2 N - 1) R) of each polarisation"
_MOLECULES = (
    "(1 - d) / (1 + d) at 90 degrees, d the depolarisation ratio: J. E. Hansen and L. D. Travis, 1974"
)
_CHANNELS: tuple[Quantity, ...] = ("grey", "S1.grey", "S2.grey", "S3.grey")


def scenes() -> Iterator[Scene]:
    """Of all light that comes the Stokes vector; parts that are zero are left out."""
    for turned in (0, 30, 75):
        yield _crossed(turned)
    for degrees in (30.0, 56.3099, 75.0):
        yield _mirror(f"glass, {degrees:g} deg", degrees, _glass(), _fresnel(degrees, 1.5), polarised=False)
    for degrees in (30.0, 60.0, 80.0):
        metal = _floor({"type": "conductor", "index": {"n": 0.9, "k": 3.2}})
        yield _mirror(
            f"metal, {degrees:g} deg", degrees, [metal], _fresnel(degrees, 0.9 + 3.2j), polarised=True
        )
    for plates in (1, 3, 10):
        yield _pile(plates)
    yield _rhomb()
    for depolarisation in (0.0, 0.0279, 0.1):
        yield _molecules(depolarisation)
    yield from _atmosphere()
    yield from _random_layers()
    yield from _iprt("A1", 0.5, 0.0)
    yield from _iprt("A2", 0.1, 0.3)


def _values(name: str, stokes: tuple[float, ...], source: str) -> tuple[Value, ...]:
    return tuple(
        Value(
            f"{name}: {'-' if truth < 0 else ''}S{number}",
            abs(truth),
            source,
            channel,
            -1.0 if truth < 0 else 1.0,
        )
        for number, (channel, truth) in enumerate(zip(_CHANNELS, stokes, strict=False))
        if abs(truth) > 1e-12
    )


def _meter(position: list[float], look_at: list[float]) -> Document:
    return {
        "type": "radiance_meter",
        "position": position,
        "look_at": look_at,
        "up": [0, 0, 1],
        "diameter": 1e-4,
        "cone_degrees": 1e-3,
        "stokes": True,
        **GREY,
    }


def _document(sensor: Document, surfaces: list[Document], **more: object) -> Document:
    return {"nocturne": 1, "sensor": sensor, "surfaces": surfaces, **more}


def _across(y: float, kernel: Document, half: float = 1.0) -> Document:
    return {"shape": quad([-half, y, -half], [0, 0, 2 * half], [2 * half, 0, 0]), "kernel": kernel}


def _lamp(y: float, half: float = 1.0) -> Document:
    return _across(y, BLACK, half) | {"luminaire": {"radiance": 1.0, "two_sided": True}}


def _floor(kernel: Document) -> Document:
    return {"shape": quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]), "kernel": kernel}


def _glass() -> list[Document]:
    """And something black below it."""
    body = {"shape": box([-1, -1, -1], [1, 1, 0]), "kernel": {"type": "dielectric", "index": 1.5}}
    return [body, {"shape": quad([-1, -1, -0.5], [2, 0, 0], [0, 2, 0]), "kernel": BLACK}]


def _crossed(degrees: float) -> Scene:
    """A polariser at 20 degrees before the lamp, and one that is turned against it by so much."""
    sensor = _meter([0, 0, 0], [0, 1, 0])

    def polariser(angle: float) -> Document:
        return {"type": "polariser", "axis": [cos(radians(angle)), 0.0, sin(radians(angle))]}

    surfaces = [_across(0.5, polariser(20 + degrees)), _across(1.0, polariser(20)), _lamp(3.0)]
    through, twice = 0.5 * cos(radians(degrees)) ** 2, radians(2 * (20 + degrees))
    stokes = (through, through * cos(twice), through * sin(twice))
    return Scene(
        _document(sensor, surfaces), _values(f"polarisers {degrees} deg apart", stokes, _MALUS), 2**8
    )


def _fresnel(degrees: float, index: complex) -> tuple[complex, complex]:
    """Of the field across and in the plane of incidence; waves go as e^(i k z)."""
    cosine = cos(radians(degrees))
    root = cmath.sqrt(index * index - (1 - cosine * cosine))
    return (cosine - root) / (cosine + root), (index**2 * cosine - root) / (index**2 * cosine + root)


def _reflected(across: complex, within: complex, *, polarised: bool) -> tuple[float, ...]:
    """Of light of 1, unpolarised or by a filter at 45 degrees."""
    mean, half = (abs(across) ** 2 + abs(within) ** 2) / 2, (abs(across) ** 2 - abs(within) ** 2) / 2
    if not polarised:
        return mean, half
    product = across * within.conjugate()
    return 0.5 * mean, 0.5 * half, 0.5 * product.real, 0.5 * product.imag


def _mirrored(degrees: float, floor: list[Document], *, polarised: bool, above: float = 1.0) -> Document:
    """A meter that looks at the floor, and a lamp where that mirrors; `above` -1: both are below it."""
    angle = radians(degrees)
    sensor = _meter([0, -sin(angle), above * cos(angle)], [0, 0, 0])
    way = np.array([0, sin(angle), above * cos(angle)])
    across, upright = np.array([0.1, 0, 0]), 0.1 * np.array([0, -cos(angle), above * sin(angle)])

    def facing(distance: float, kernel: Document, **more: object) -> Document:
        corner = distance * way - 0.5 * (across + upright)
        return {"shape": quad(corner.tolist(), upright.tolist(), across.tolist()), "kernel": kernel, **more}

    axis = np.array([1.0, 0, 0]) + np.cross(-way, [1.0, 0, 0])
    filters = [facing(1.0, {"type": "polariser", "axis": axis.tolist()})] if polarised else []
    lamp = facing(2.0, BLACK, luminaire={"radiance": 1.0, "two_sided": True})
    return _document(sensor, [*floor, lamp, *filters])


def _mirror(
    name: str, degrees: float, floor: list[Document], amplitudes: tuple[complex, complex], *, polarised: bool
) -> Scene:
    stokes = _reflected(*amplitudes, polarised=polarised)
    document = _mirrored(degrees, floor, polarised=polarised)
    return Scene(document, _values(name, stokes, _FRESNEL), 2**15 if len(floor) > 1 else 2**8)


def _rhomb() -> Scene:
    """Meter, filter and lamp are in the glass."""
    degrees = 50.229
    glass = {"shape": box([-5, -5, -5], [5, 5, 0]), "kernel": {"type": "dielectric", "index": 1.51}}
    stokes = _reflected(*_fresnel(degrees, 1 / 1.51), polarised=True)
    document = _mirrored(degrees, [glass], polarised=True, above=-1.0)
    # All of it is mirrored: S1 is nothing but rounding.
    return Scene(document, _values("rhomb", (stokes[0], 0.0, *stokes[2:]), _RHOMB), 2**8)


def _pile(plates: int) -> Scene:
    """At Brewster's angle; plates lean towards the light, so that the plane of incidence holds up."""
    degrees = 56.3099
    angle = radians(degrees)
    normal, along = np.array([0, cos(angle), sin(angle)]), np.array([0, -sin(angle), cos(angle)])
    surfaces = []
    for number in range(plates):
        corners = [
            (0.5 + 0.02 * number + 0.01 * back) * normal
            + 40 * right * np.array([1.0, 0, 0])
            + 40 * up * along
            for back in (0, 1)
            for right, up in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
        faces = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
        for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
            faces += [[a, a + 4, b + 4], [a, b + 4, b]]
        mesh = {"type": "mesh", "vertices": [each.tolist() for each in corners], "triangles": faces}
        surfaces.append({"shape": mesh, "kernel": {"type": "dielectric", "index": 1.5}})
    s, p = (
        (1 - share) / (1 + (2 * plates - 1) * share)
        for share in (abs(each) ** 2 for each in _fresnel(degrees, 1.5))
    )
    document = _document(_meter([0, 0, 0], [0, 1, 0]), [*surfaces, _lamp(30.0, 15.0)])
    return Scene(document, _values(f"pile of {plates}", ((s + p) / 2, (s - p) / 2), _PILE), 2**14)


def _molecules(depolarisation: float) -> Scene:
    """Light that a thin ball scatters once, by the phase function, and how polarised it is."""
    scattering, radius = 1e-3, 1.0
    air = {
        "scattering": scattering,
        "absorption": 0.0,
        "phase": {"type": "rayleigh", "depolarisation": depolarisation},
    }
    ball = {
        "shape": {"type": "sphere", "centre": [0, 2, 0], "radius": radius},
        "interior": {"media": ["air"]},
    }
    document = _document(_meter([0, 0, 0], [0, 2, 0]), [ball], media={"air": air}, distant=[sun(0)])
    document["tracing"] = {"maximum_depth": 1}
    gamma = depolarisation / (2 - depolarisation)
    phase = 3 / (16 * pi * (1 + 2 * gamma)) * (1 + 3 * gamma)
    # Along the line of sight light has come down through the ball, by the height of the ball there.
    at = (np.arange(20_000) + 0.5) / 10_000 - 1.0
    lost = np.exp(-scattering * (np.sqrt(1 - at**2) + at + 1.0))
    light = float(scattering * phase * 2.0 * np.mean(lost))
    stokes = (light, light * (1 - depolarisation) / (1 + depolarisation))
    return Scene(
        document, _values(f"molecules, depolarisation {depolarisation:g}", stokes, _MOLECULES), 2**14
    )


def _atmosphere() -> Iterator[Scene]:
    """Light that leaves a Rayleigh layer upwards. Azimuths are from the direction of the Sun's light; Q is
    positive across the meridian plane as S1 is, and the sign of U tells on which side the Sun is."""
    known = truths("polarisation")["coulson"]
    for row, mu in enumerate(known["cosines"]):
        for column, azimuth in enumerate(known["azimuths"]):
            if mu == 1.0 and azimuth:
                # Straight up there is no azimuth: another direction of the sensor's right.
                continue
            light = sun(float(np.degrees(np.arccos(0.2))), irradiance=pi)
            up = [1, 0, 0] if mu == 1.0 else [0, 0, 1]
            document = _layer(_Layer(0.5), _upwards(mu, azimuth), light, up)
            stokes = tuple(known[name][row][column] for name in "IQU")
            name = f"atmosphere, mu {mu:g}, {azimuth} deg"
            yield Scene(document, _values(name, stokes, known["source"]), 2**15)


def _random_layers() -> Iterator[Scene]:
    """Q and U have the other sign there."""
    known = truths("polarisation")["layers"]
    for number, (depth, albedo, depolarisation, ground, mu0, mu, azimuth, i, q, u) in enumerate(
        known["rows"]
    ):
        layer = _Layer(depth, albedo, depolarisation, ground)
        light = sun(float(np.degrees(np.arccos(mu0))))
        document = _layer(layer, _upwards(mu, azimuth), light, [0, 0, 1])
        yield Scene(document, _values(f"layer {number}", (i, -q, -u), known["source"]), 2**15)


def _iprt(case: str, depth: float, ground: float) -> Iterator[Scene]:
    """Seen from below and from above; angles are of the direction of view, Q is positive along the meridian
    plane, and U has the other sign. Where zenith or nadir are seen azimuths say where that plane is."""
    known = truths("polarisation")[f"iprt {case}"]
    for depolarisation, zenith, azimuth, tilt, turned, i, q, u in known["rows"]:
        across, angle = sin(radians(tilt)), radians(turned)
        view = np.array([across * cos(angle), across * sin(angle), cos(radians(tilt))])
        along = np.array([cos(angle), sin(angle), 0.0])
        up = {0.0: -along, 180.0: along}.get(tilt, np.array([0.0, 0.0, 1.0])).tolist()
        layer = _Layer(depth, 1.0, depolarisation, ground)
        document = _layer(layer, view, sun(zenith, azimuth), up)
        name = f"IPRT {case}, depolarisation {depolarisation:g}, Sun {zenith:g}, view {tilt:g}/{turned:g} deg"
        yield Scene(document, _values(name, (i, -q, -u), known["source"]), 2**15)


@dataclass(frozen=True)
class _Layer:
    """Of molecules, above a ground."""

    depth: float
    """Optical."""
    albedo: float = 1.0
    depolarisation: float = 0.0
    ground: float = 0.0


def _upwards(mu: float, azimuth: float) -> NDArray[np.float64]:
    """The direction of view against light that leaves upwards; the Sun's goes towards -x."""
    across, angle = sqrt(1 - mu * mu), radians(azimuth)
    return -np.array([-across * cos(angle), across * sin(angle), mu])


def _layer(layer: _Layer, view: NDArray[np.float64], light: Document, up: Sequence[float]) -> Document:
    """As deep as its optical depth in m; seen from just above it, or from just below, where the ground is."""
    from_above = view[2] < 0.0
    at = np.array([0.0, 0.0, 0.0 if from_above else -layer.depth]) - _NEAR * view
    meter = _meter(at.tolist(), (at + view).tolist()) | {"up": [*up]}
    phase = {"type": "rayleigh", "depolarisation": layer.depolarisation}
    air = {"scattering": layer.albedo, "absorption": 1.0 - layer.albedo, "phase": phase}
    surfaces = [slab(layer.depth, _WIDE, "air")]
    if layer.ground:
        below = -layer.depth - 2 * _NEAR
        ground = quad([-_WIDE, -_WIDE, below], [2 * _WIDE, 0, 0], [0, 2 * _WIDE, 0])
        surfaces.append({"shape": ground, "kernel": diffuse(layer.ground)})
    return _document(meter, surfaces, media={"air": air}, distant=[light])


_NEAR, _WIDE = 1e-3, 100.0
"""m; with a scattering coefficient of 1 / m no light comes from beyond the layer's edges."""
