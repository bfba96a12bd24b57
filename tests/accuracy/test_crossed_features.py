"""Where two features meet: what changes nothing must change nothing, and both directions agree.

Each scene is traced with eight seeds; the mean is compared by Student's t with the errors that these tell.
False alarms: 0.001 for each case. Seeds are fixed.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import compile_to
from nocturne_scene.validation.documents import BLACK, GREY, box, diffuse, film, quad, sphere, surface
from scipy import stats

from tests.accuracy.eight_seeds import differ, means
from tests.accuracy.scenes import bowl
from tests.accuracy.tracing import IN_FULL, Document, part_of, run_seeds, trace, write

pytestmark = pytest.mark.system

_SEEDS = 8


def _lit_floor(*between: Document) -> Document:
    camera = {"type": "pinhole", "position": [0, 1.2, -1.5], "look_at": [0, 0, 0]}
    floor = surface(quad([-2, 0, -2], [0, 0, 4], [4, 0, 0]), diffuse(0.8))
    lamp = surface(quad([-0.15, 2.0, -0.15], [0.3, 0, 0], [0, 0, 0.3]), BLACK, 10.0)
    sensor = camera | {"vertical_field_of_view_degrees": 25}
    return {"nocturne": 1, "sensor": sensor, "surfaces": [floor, lamp, *between]}


def _ball(index: float, roughness: float) -> Document:
    glass = {"type": "dielectric", "index": index, "roughness": roughness}
    return surface(sphere([0, 0.5, 0], 0.35), glass)


@pytest.mark.parametrize("roughness", [0.02, 0.2])
def test_a_rough_ball_of_equal_index_is_not_there(roughness: float, tmp_path: Path) -> None:
    """Light sent towards the lamp goes on where the boundary is none: 0.35 of the right value before."""
    without = means(_lit_floor(), tmp_path / "without")
    assert not differ(without, means(_lit_floor(_ball(1.0, roughness)), tmp_path / "ball"))


def test_frosted_glass_in_oil_of_its_index_is_not_there(tmp_path: Path) -> None:
    """0.43 of the right value before."""
    oil = surface(box([-3, -3, -3], [3, 3, 3]), {"type": "dielectric", "index": 1.5})
    frosted = {"type": "dielectric", "index": 1.5, "roughness": 0.3, "priority": 1}
    within = surface(sphere([0, 0.5, 0], 0.35), frosted)
    without = means(_lit_floor(oil), tmp_path / "without")
    assert not differ(without, means(_lit_floor(oil, within), tmp_path / "ball"))


def test_a_rough_body_of_lower_priority_within_another_is_not_seen(tmp_path: Path) -> None:
    """0.07 of the right value before."""
    tank = surface(box([-3, -3, -3], [3, 3, 3]), {"type": "dielectric", "index": 1.33, "priority": 1})
    unseen = {"type": "dielectric", "index": 1.5, "roughness": 0.3, "priority": 0}
    within = surface(box([-0.4, 0.5, -0.4], [0.4, 0.9, 0.4]), unseen)
    without = means(_lit_floor(tank), tmp_path / "without")
    assert not differ(without, means(_lit_floor(tank, within), tmp_path / "within"))


def test_a_lamp_that_grows_sends_photons_by_its_largest_size(tmp_path: Path) -> None:
    """From a thousandth of its size; 0.03 of the right value before, by half a million photons."""
    growing = surface(quad([-0.5, 0, -0.5], [1, 0, 0], [0, 0, 1]), BLACK, 10.0)
    growing["motion"] = {"placements": [{"scale": s, "translate": [0, 1.5, 0]} for s in (0.001, 1.0)]}
    constant = surface(quad([1.4, 1.5, -0.1], [0.2, 0, 0], [0, 0, 0.2]), BLACK, 10.0)
    document = {"nocturne": 1, "sensor": film([0, 0, 0], [0, 1, 0], 0.3), "surfaces": [growing, constant]}
    adjoint = means(document, tmp_path / "adjoint")
    forward = means(document, tmp_path / "forward", direction="forward", photons_together=1)
    assert np.std(forward) < 0.1 * np.mean(forward)
    assert not differ(adjoint, forward)


@pytest.mark.parametrize("direction", ["forward", "both"])
def test_photons_of_the_sun_do_not_ignore_fog_without_bounds(direction: str, tmp_path: Path) -> None:
    """A Sun through e^-1 of haze read 2.7 times too much."""
    document = _lit_floor() | {"media": {"haze": {"absorption": 0.1}}, "unbounded_media": ["haze"]}
    if direction == "forward":
        document["sensor"] = film([0, 0.01, 0], [0, 1, 0], 0.3)
    document["distant"] = [{"direction": [0, 1, 0], "irradiance": 1.0}]
    document["tracing"] = {"direction": direction}
    with pytest.raises(NocturneClientError) as raised:
        compile_to(write(document, tmp_path), tmp_path, 8, 8, 16)
    assert [problem.place for problem in raised.value.problems] == ["$.tracing.direction"]


def test_a_wide_ground_leaves_caustics_to_photons_from_the_lamp(tmp_path: Path) -> None:
    """On a ground of 4 km all was near the camera, and both directions were photons from there."""
    ground = surface(quad([-2000, 0, -2000], [0, 0, 4000], [4000, 0, 0]), diffuse(0.8))
    document = _lit_floor() | {"important_directions": [{"shape": sphere([0, 0.4, 0], 0.3)}]}
    lamp = surface(sphere([0.3, 2, 0], 0.03), BLACK, 1000.0)
    document["surfaces"] = [
        ground,
        lamp,
        surface(sphere([0, 0.4, 0], 0.3), {"type": "dielectric", "index": 1.5}),
    ]
    mixture = {"kernel": 0.5, "luminaires": 0.5}
    adjoint = means(document, tmp_path / "adjoint", mixture=mixture)
    both = means(document, tmp_path / "both", mixture=mixture, direction="both", aimed_emission=0.9)
    assert np.std(both) < 0.6 * np.std(adjoint)


def test_the_sun_on_glass_above_a_wide_ground(tmp_path: Path) -> None:
    """Nothing is aimed: one photon in 2e7 of a disc as wide as the ground met the ball, and its caustic was
    missing from both directions (0.69 of the light). The truth is by photons from the camera."""
    document = _lit_floor(_ball(1.5, 0.0))
    document["surfaces"][0] = surface(quad([-1000, 0, -1000], [0, 0, 2000], [2000, 0, 0]), diffuse(0.8))
    document["distant"] = [{"direction": [0, 1, 0], "angular_diameter_degrees": 20.0, "irradiance": 1.0}]
    adjoint = means(document, tmp_path / "adjoint")
    both = means(document, tmp_path / "both", direction="both", aimed_emission=0)
    assert not differ(adjoint, both)


def _lamp_in_a_housing(fog_from: float) -> Document:
    """A small lamp at x = -1.5 m, in a silver bowl behind a cover of glass, and fog from `fog_from` on. The
    camera, in clear air behind the lamp, sees the floor and the fog before it."""
    silver = {"type": "two_sided", "front": {"type": "conductor", "index": "Ag"}, "back": BLACK}
    placed = {"rotate": {"axis": [0, 1, 0], "degrees": 90}, "translate": [-1.44, 0.9, 0]}
    cover = surface(box([-1.43, 0.7, -0.2], [-1.41, 1.1, 0.2]), {"type": "dielectric", "index": 1.5})
    camera = {"type": "pinhole", "position": [-1.9, 1.4, 2.6], "look_at": [0.9, 0.4, 0]}
    fog = {"scattering": 0.25, "phase": {"type": "henyey_greenstein", "g": 0.5}}
    surfaces = [
        surface(quad([-3, 0, -3], [0, 0, 6], [6, 0, 0]), diffuse(0.5)),
        surface(quad([2.5, 0, -3], [0, 0, 6], [0, 3, 0]), diffuse(0.5)),
        surface(sphere([-1.5, 0.9, 0], 0.02), BLACK, 1e4),
        surface(bowl(0.16, 1.2, 8, 24), silver) | placed,
        cover,
        {"shape": box([fog_from, -0.1, -2.9], [2.4, 2.9, 2.9]), "interior": {"media": ["fog"]}},
    ]
    sensor = camera | {"vertical_field_of_view_degrees": 50}
    return {"nocturne": 1, "sensor": sensor, "surfaces": surfaces, "media": {"fog": fog}}


def test_fog_in_a_lamp_leaves_its_light_to_photons_from_there(tmp_path: Path) -> None:
    """What fog in the housing scatters first, and the cover gathers, was left to photons from the camera: six
    times the scatter of the same lamp with fog before it alone, twice now."""
    scatter = [
        np.std(means(_lamp_in_a_housing(fog_from), tmp_path / str(fog_from), direction="both"))
        for fog_from in (-1.65, -1.405)
    ]
    assert scatter[0] < 3.0 * scatter[1]


@pytest.mark.parametrize("direction", ["forward", "both"])
def test_photons_of_the_sun_do_not_start_around_the_planet(direction: str, tmp_path: Path) -> None:
    """None of them met a film of 0.3 m, which read 0."""
    document = _lit_floor() | {"atmosphere": {}, "distant": [{"direction": [0, 1, 0], "sun": True}]}
    if direction == "forward":
        document["sensor"] = film([0, 0.01, 0], [0, 1, 0], 0.3)
    document["tracing"] = {"direction": direction}
    with pytest.raises(NocturneClientError) as raised:
        compile_to(write(document, tmp_path), tmp_path, 8, 8, 16)
    assert [problem.place for problem in raised.value.problems] == ["$.tracing.direction"]


def test_a_thousand_mirrors_keep_the_length_of_a_direction(tmp_path: Path) -> None:
    """Between turned mirrors 1 m apart the path to a lamp 95 m away is 950 m long, in a medium that absorbs
    1/km. Directions that grew or shrank by a rounding at each mirror would change that. Each ray starts 2^-20
    of its coordinates off a mirror, which makes the path 1e-4 longer."""
    axis, angle, sine = np.array([1.0, 0.3, 0.2]), math.radians(33.0), 0.1
    axis /= np.linalg.norm(axis)
    along = np.array([sine, 0.0, math.sqrt(1.0 - sine * sine)])
    turned = along * math.cos(angle) + np.cross(axis, along) * math.sin(angle)
    turned += axis * np.dot(axis, along) * (1.0 - math.cos(angle))
    mirror = {"type": "conductor", "index": {"n": 0.001, "k": 1000.0}}
    hall = [
        surface(quad([-1, -5, -0.5], [97, 0, 0], [0, 10, 0]), mirror),
        surface(quad([-1, -5, 0.5], [0, 10, 0], [97, 0, 0]), mirror),
        surface(quad([95, -5, -1], [0, 0, 2], [0, 10, 0]), BLACK, 1.0, two_sided=True),
    ]
    thin = {"type": "dielectric", "index": 1.0, "absorption": 1e-3}
    meter = {"type": "radiance_meter", "position": [0, 0, 0], "look_at": turned.tolist(), "diameter": 1e-6}
    document: Document = {"nocturne": 1, "sensor": meter | {"cone_degrees": 1e-4, **GREY}}
    document |= {"groups": {"hall": hall}, "surfaces": [surface(box([-300] * 3, [300] * 3), thin)]}
    document["instances"] = [{"group": "hall", "rotate": {"axis": axis.tolist(), "degrees": 33.0}}]
    document["tracing"] = {"direction": "adjoint", "h": 1e6}
    read = trace(document, tmp_path, 4, 16).further["grey"] / 470.0
    assert np.abs(read / math.exp(-0.95) - 1.0).max() < 3e-4


def _needles(count: int) -> str:
    """A closed double cone as PLY: tips at z = 1 and -1, a ring of radius 1 between them."""
    turns = [2 * math.pi * i / count for i in range(count)]
    corners = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), *((math.cos(t), math.sin(t), 0.0) for t in turns)]
    faces = []
    for i in range(count):
        one, other = 2 + i, 2 + (i + 1) % count
        faces += [(0, one, other), (1, other, one)]
    head = f"ply\nformat ascii 1.0\nelement vertex {len(corners)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    points = "".join(f"{x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in corners)
    return head + points + "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)


_NEEDLES = [("at rest", 10_000)]
if IN_FULL:
    _NEEDLES += [("at rest", 1000), ("instance", 1000), ("instance", 10_000), ("moving", 1000)]


@pytest.mark.parametrize(("way", "count"), _NEEDLES)
def test_a_furnace_of_needles_loses_nothing(way: str, count: int, tmp_path: Path) -> None:
    """Albedo and emission one half, so that radiance is 1 everywhere; 0.994 before for 1,000 by hits off
    their planes, 0.963 for 10,000 by directions towards them."""
    cone = surface({"type": "mesh", "asset": "needles.ply"}, diffuse(0.5), 0.5, two_sided=True)
    if way == "moving":
        cone["motion"] = {"translate": [0.01, 0, 0]}
    document: Document = {"nocturne": 1, "surfaces": [] if way == "instance" else [cone]}
    document["sensor"] = {"type": "panorama", "position": [0.1, 0.05, 0.02], "look_at": [1, 0.05, 0.02]}
    document["sensor"] |= {"up": [0, 0, 1], **GREY}
    if way == "instance":
        document |= {"groups": {"cone": [cone]}, "instances": [{"group": "cone"}]}
    (tmp_path / "needles.ply").write_text(_needles(count))
    compiled = compile_to(write(document, tmp_path), tmp_path, 16, 8, part_of(512 if count == 1000 else 16))
    means = [
        float(image.further["grey"].mean()) / 470.0 for image, _ in run_seeds(compiled, tmp_path, _SEEDS)
    ]
    assert stats.ttest_1samp(means, 1.0).pvalue > 0.001


@pytest.mark.parametrize("estimator", ["mixture", "split"])
def test_photons_drawn_to_the_sun_pass_a_mask_whatever_they_weigh(estimator: str, tmp_path: Path) -> None:
    """The Sun lights a floor through a screen of half opacity, the floor a ceiling that the camera sees: the
    second vertex sends the photon. Its weight of 6e-5 ended it at the screen: 0 by most seeds before."""
    half = {"type": "mask", "kernel": BLACK, "opacity": 0.5}
    screen = surface(quad([1, 1.5, -2], [0, 0, 4], [3, 0, 0]), half)
    document = {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [-1, 1.0, 0],
            "look_at": [-1, 1.5, 0.01],
            "vertical_field_of_view_degrees": 25,
        },
        "surfaces": [
            surface(quad([-3, 1.5, -2], [0, 0, 4], [4, 0, 0]), diffuse(0.8)),
            surface(quad([-3, 0, -2], [0, 0, 4], [7, 0, 0]), diffuse(0.8)),
            screen,
        ],
        "distant": [{"direction": [0, 1, 0], "angular_diameter_degrees": 0.53, "irradiance": 1.0}],
    }
    apart = means(document, tmp_path / "apart")
    drawn = means(document, tmp_path / estimator, estimator=estimator)
    assert np.std(drawn) < 0.3 * np.mean(drawn)
    assert not differ(apart, drawn)


def _ice(kernel: Document, bubble: Document) -> Document:
    return {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0, 0, 4],
            "look_at": [0, 0, 0],
            "vertical_field_of_view_degrees": 30,
        },
        "environment": {"radiance": 0.1},
        "surfaces": [
            surface(quad([-5, -5, -2], [10, 0, 0], [0, 10, 0]), diffuse(0.5)),
            surface(sphere([0, 0, 0], 1), kernel),
            surface(sphere([0.2, 0, 0], 0.5), bubble),
            surface(sphere([0.5, 2, 0], 0.2), BLACK, 10.0),
        ],
    }


@pytest.mark.parametrize("roughness", [0.0, 0.2])
def test_a_boundary_between_two_indices_is_that_of_a_body(roughness: float, tmp_path: Path) -> None:
    """A bubble in ice: by bodies and priorities, and by boundaries that know their two indices alone."""
    rough = {"roughness": roughness}
    bodies = _ice(
        {"type": "dielectric", "index": 1.31} | rough,
        {"type": "dielectric", "index": 1.0, "priority": 1} | rough,
    )
    boundaries = _ice(
        {"type": "dielectric", "index": 1.31, "outside": 1.0} | rough,
        {"type": "dielectric", "index": 1.0, "outside": 1.31} | rough,
    )
    by_bodies = means(bodies, tmp_path / "bodies")
    assert not differ(by_bodies, means(boundaries, tmp_path / "boundaries"))
    assert not differ(by_bodies, means(boundaries, tmp_path / "both", direction="both"))


def test_a_bubble_of_equal_priority_is_not_there(tmp_path: Path) -> None:
    """So that the scene above can tell; the compiler warns of it."""
    ice, air = ({"type": "dielectric", "index": index} for index in (1.31, 1.0))
    seen = means(_ice(ice, air | {"priority": 1}), tmp_path / "seen")
    assert differ(seen, means(_ice(ice, air), tmp_path / "hidden"))
