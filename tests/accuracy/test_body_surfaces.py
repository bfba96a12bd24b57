"""Bodies of a medium whose boundary is seen: masks, panes, cloth and blends that bound fog.

One surface that is both must equal two: the same surface around no body, and an invisible body of fog just
within it. The surroundings are air; smoke, which adds to the fog; water, which keeps it out; and water of a
lower priority, which the fog replaces. Glass with the index of its surroundings in a band of wavelengths only
(a Christiansen filter) separates photons that travel together; they are compared with photons that travel
alone. False alarms: 0.001 for each image.
"""

from pathlib import Path

import pytest
from nocturne_scene.validation.documents import BLACK, box, diffuse, quad, surface

from tests.accuracy.eight_seeds import differ, means
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_PANE = {"type": "thin_pane", "index": 1.5, "transmittance": 0.9}
_PAINT = {"type": "coated_diffuse", "reflectance": 0.7, "index": 1.5}
_SURFACES = {
    "mask": {"type": "mask", "kernel": diffuse(0.8), "opacity": 0.5},
    "hole": {"type": "mask", "kernel": diffuse(0.8), "opacity": 0.0},
    "pane": _PANE,
    "blend": {"type": "blend", "first": _PANE, "second": diffuse(0.6), "weight": 0.3},
    "masked paint": {"type": "mask", "kernel": _PAINT, "opacity": 0.5},
    "masked pane": {"type": "mask", "kernel": _PANE, "opacity": 0.5},
    "cloth": {"type": "diffuse_transmitter", "reflectance": 0.3, "transmittance": 0.5},
}
_IN_FOG = {"interior": {"media": ["fog"]}}
_SMOKE = {"shape": box([-1.5, -0.1, -1.5], [1.5, 1.1, 1.4]), "interior": {"media": ["smoke"]}}


def _water(priority: int) -> Document:
    return surface(box([-3] * 3, [3] * 3), {"type": "dielectric", "index": 1.33, "priority": priority})


_AROUND = {"air": [], "smoke": [_SMOKE], "water": [_water(1)], "less than fog": [_water(-1)]}


def _scene(*surfaces: Document) -> Document:
    camera = {"type": "pinhole", "position": [0, 1.2, -1.8], "look_at": [0, 0.3, 0]}
    floor = surface(quad([-2, 0, -2], [0, 0, 4], [4, 0, 0]), diffuse(0.8))
    lamp = surface(quad([-0.4, 2.0, -0.4], [0.8, 0, 0], [0, 0, 0.8]), BLACK, 10.0)
    media = {"fog": {"scattering": 1.0, "absorption": 1.0}, "smoke": {"scattering": 0.1, "absorption": 0.3}}
    sensor = camera | {"vertical_field_of_view_degrees": 35}
    return {"nocturne": 1, "sensor": sensor, "surfaces": [floor, lamp, *surfaces], "media": media}


def _block(inset: float = 0.0) -> Document:
    low, high = [-0.5, 0.3, -0.5], [0.5, 0.9, 0.5]
    return box([each + inset for each in low], [each - inset for each in high])


@pytest.mark.parametrize("around", _AROUND)
@pytest.mark.parametrize("name", _SURFACES)
def test_a_seen_boundary_of_fog_is_a_surface_around_it(name: str, around: str, tmp_path: Path) -> None:
    """By photons of one direction that share, and by both directions."""
    apart = [surface(_block(), _SURFACES[name])]
    if around != "water":
        apart.append({"shape": _block(2e-4), **_IN_FOG})
    truth = means(_scene(*_AROUND[around], *apart), tmp_path / "apart", 512)
    one = _scene(*_AROUND[around], surface(_block(), _SURFACES[name]) | _IN_FOG)
    assert not differ(truth, means(one, tmp_path / "one", 256, sharing=16))
    assert not differ(truth, means(one, tmp_path / "both", 256, direction="both"))


@pytest.mark.parametrize("fog", [{}, _IN_FOG], ids=["clear", "fog"])
@pytest.mark.parametrize("roughness", [0.0, 0.02, 0.3])
@pytest.mark.parametrize("around", ["air", "less than fog"])
def test_an_index_that_is_equal_in_a_band_alone(
    around: str, roughness: float, fog: Document, tmp_path: Path
) -> None:
    same = 1.0 if around == "air" else 1.33
    other = same + 0.2
    band = [[400, other], [539, other], [540, same], [561, same], [562, other], [700, other]]
    glass = {"type": "dielectric", "index": {"table": band}, "roughness": roughness}
    scene = _scene(*_AROUND[around], surface(_block(), glass) | fog)
    alone = means(scene, tmp_path / "alone", 512, photons_together=1)
    assert not differ(alone, means(scene, tmp_path / "together", 256))
    assert not differ(alone, means(scene, tmp_path / "both", 256, direction="both", sharing=16))


def test_lanes_that_part_at_such_glass_are_all_counted(tmp_path: Path) -> None:
    """Photons that a facet sends nowhere had 0 / 0 for their weight where a mirror then showed them the lamp:
    2 of 65,536 samples. That no sample is invalid is asserted wherever an image is read."""
    band = [[400, 1.3], [540, 1.3], [541, 1.0], [560, 1.0], [561, 1.3], [700, 1.3]]
    ball = {"type": "sphere", "centre": [0, 0, 0], "radius": 0.4}
    camera = {"type": "pinhole", "position": [0, 0.5, -2], "look_at": [0, 0, 0]}
    scene: Document = {"nocturne": 1, "sensor": camera | {"vertical_field_of_view_degrees": 25}}
    scene["surfaces"] = [
        surface(
            quad([-2, -1, -2], [0, 0, 4], [4, 0, 0]), {"type": "conductor", "index": {"n": 0.2, "k": 3.0}}
        ),
        surface(ball, {"type": "dielectric", "index": {"table": band}, "roughness": 0.3}),
        surface(quad([-0.5, 2, -0.5], [1, 0, 0], [0, 0, 1]), BLACK, 10.0),
    ]
    together = means(scene, tmp_path / "together", 2048, photons_together=4)
    assert not differ(means(scene, tmp_path / "alone", 2048, photons_together=1), together)
