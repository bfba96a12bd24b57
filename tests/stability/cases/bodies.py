"""Transparent bodies: thin, nested, touching, around the camera."""

from math import cos, pi, radians

from nocturne_scene.validation.documents import sphere

from tests.accuracy.tracing import Document
from tests.stability.build import beam, box, diffuse, film, fresnel, lit, quad, surface
from tests.stability.case import Case


def _glass(index: float, **more: object) -> Document:
    return {"type": "dielectric", "index": index, **more}


def _dark_above(z: float = 3.0) -> Document:
    return surface(quad([-1e4, -1e4, z], [2e4, 0, 0], [0, 2e4, 0]))


def _plate(index: float) -> Case:
    """Light from below, through a plate."""
    plate = surface(box([-10, -10, -1], [10, 10, 0]), _glass(index))
    return Case(
        f"plate of index {index:g}",
        "an index near that of air, or far from it",
        lit(beam(0.0), [plate, _dark_above()]),
        2.0 * index / (index**2 + 1.0),
        "all inner reflections of a clear plate: 2 n / (n^2 + 1)",
    )


def _pile(thickness: float) -> Case:
    half = 10.0 if thickness > 1e-3 else 0.01
    plates = [
        surface(box([-half, -half, -(2 * i + 1) * thickness], [half, half, -2 * i * thickness]), _glass(1.5))
        for i in range(10)
    ]
    return Case(
        f"ten plates of {thickness:g} m",
        "gaps and plates, thin compared with their width",
        lit(beam(0.0), [*plates, _dark_above()]),
        0.54545455,
        "Stokes 1862: (1 - r) / (1 + (2 m - 1) r), m plates",
        samples=512,
    )


def _shell(gap: float) -> Case:
    """A white ball under a shell of glass, seen in the middle."""
    inside, r, albedo = 0.59634576, 0.04, 0.5
    balls = [
        surface(sphere([0, 0, 0], 1.0 + gap), _glass(1.5)),
        surface(sphere([0, 0, 0], 1.0), diffuse(albedo)),
    ]
    return Case(
        f"ball under {gap:g} m of glass",
        "a thin shell around a diffuse ball",
        lit(beam(0.0, 1e-3, 3.0), balls),
        r + (1.0 - r) * albedo * (1.0 - inside) / (1.0 - albedo * inside),
        "flat layer on a diffuse base: r + (1 - r) a (1 - R_in) / (1 - a R_in), R_in the diffuse Fresnel "
        "reflectance from inside",
        allowed=3.0 * gap + 1e-4,
        samples=512,
        remedy="a shell thicker than 1e-5 of the body, or the kernel coated_diffuse",
    )


def _nested(reach: float) -> Case:
    """Water under glass, seen from above, lit from below."""
    name = f"overlap by {reach:g} m" if reach > 0 else "touch" if reach == 0 else f"gap of {-reach:g} m"
    ratios = (1.5, 1.5 / 1.33, 1.33) if reach >= 0 else (1.5, 1.5, 1.33, 1.33)
    reflected = [((n - 1.0) / (n + 1.0)) ** 2 for n in ratios]
    truth = 1.0 / (1.0 + sum(r / (1.0 - r) for r in reflected))
    bodies = [
        surface(box([-0.01, -0.01, 0.0], [0.01, 0.01, 1.0]), _glass(1.5, priority=1)),
        surface(box([-0.01, -0.01, -1.0], [0.01, 0.01, reach]), _glass(1.33)),
    ]
    return Case(
        f"water under glass: {name}",
        "two bodies that meet",
        lit(beam(0.0, 1e-3, 2.5), [*bodies, _dark_above()]),
        truth,
        "incoherent sum of all inner reflections at three (with a gap: four) boundaries",
        samples=512,
        remedy="let one body reach into the other, and give them priorities",
    )


def _camera_in_glass() -> Case:
    """In the middle of a ball, every ray meets its surface at a right angle."""
    return Case(
        "camera in the middle of a glass ball",
        "the sensor is inside of a dielectric",
        lit(
            {
                "type": "pinhole",
                "position": [0, 0, 0],
                "look_at": [0, 0, 1],
                "vertical_field_of_view_degrees": 60,
            },
            [surface(sphere([0, 0, 0], 1.0), _glass(1.5))],
        ),
        1.5**2,
        "radiance is n^2 times as large in clear glass that is in equilibrium with even light",
    )


def _light_guide(length: float) -> Case:
    """A square rod; light comes from its far end only. Depth grows with its length."""
    rod = surface(box([-0.5, -0.5, -length], [0.5, 0.5, 0.0]), _glass(1.5))
    lamp = surface(quad([-1e3, -1e3, -length - 0.1], [2e3, 0, 0], [0, 2e3, 0]), radiance=1.0)
    r = fresnel(45.0, 1.5)
    return Case(
        f"light guide {length:g} times as long as wide",
        "total reflection, hundreds of times",
        lit(beam(45.0, 1e-3), [rod, lamp], sky=None),
        (1.0 - r) / (1.0 + r),
        "sides lose nothing; two ends: (1 - r) / (1 + r)",
        samples=64,
        remedy="no limit of $.tracing.maximum_depth",
    )


def _clear_ball() -> Case:
    return Case(
        "clear glass ball",
        "everything that glass does, at every angle",
        lit(beam(0.0, 2.0, 5.0), [surface(sphere([0, 0, 0], 1.0), _glass(1.5))]),
        1.0,
        "clear glass in even light can't be seen",
    )


def _dispersive_cube() -> Case:
    cube = surface(box([-1, -1, -1], [1, 1, 1]), {"type": "dielectric", "index": "N-SF11"})
    cube["rotate"] = {"axis": [1, 1, 0], "degrees": 30}
    return Case(
        "cube of dense flint",
        "dispersion, edges and total reflection",
        lit(beam(0.0, 2.0, 5.0), [cube]),
        1.0,
        "clear glass in even light can't be seen",
    )


def _sun_through(pane: Document, name: str, by_film: bool) -> Case:
    """A white tile or a film under glass, in the sun; the sky is black.

    The tile is so small that light from it to the glass does not return.
    """
    r = fresnel(30.0, 1.5)
    tile = surface(quad([-0.01, -0.01, 0], [0.02, 0, 0], [0, 0.02, 0]), diffuse(1.0))
    sensor = film([0, 0, 0.1], [0, 0, 1], 0.5) if by_film else beam(45.0, distance=0.5)
    document = lit(sensor, [pane, tile], sky=None)
    document["distant"] = [{"direction": [0.5, 0.0, cos(radians(30.0))], "irradiance": 1.0}]
    return Case(
        f"sun through {name}" + (", on a film" if by_film else ""),
        "a lamp of 7e-5 sr behind glass",
        document,
        cos(radians(30.0)) * (1.0 - r) / (1.0 + r) / (1.0 if by_film else pi),
        "plane-parallel glass keeps directions: cos 30 (1 - r) / (1 + r)",
        allowed=2e-4,
        samples=1024,
        remedy="forward photons on a film; a thin_pane for window glass",
    )


_PANE = surface(quad([-2, -2, 1], [4, 0, 0], [0, 4, 0]), {"type": "thin_pane", "index": 1.5})
_PLATE = surface(box([-2, -2, 0.9], [2, 2, 1.0]), _glass(1.5))

CASES = [
    *map(_plate, (1.0, 1.0001, 4.0)),
    *map(_pile, (1.0, 1e-6)),
    *map(_shell, (1e-2, 1e-4, 1e-6)),
    *map(_nested, (1e-6, 0.0, -1e-6)),
    _camera_in_glass(),
    _light_guide(100.0),
    _clear_ball(),
    _dispersive_cube(),
    _sun_through(_PANE, "a thin pane", by_film=False),
    _sun_through(_PLATE, "a glass plate", by_film=False),
    _sun_through(_PLATE, "a glass plate", by_film=True),
]
