"""Every sensor has its frame and its curves; tracing fits the scene."""

import json
import math
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import parse_document
from nocturne_scene.errors import InputError

from .conftest import Compile

VIEW: dict[str, Any] = {"position": [0, 0, -2], "look_at": [0, 1, 0]}
SENSORS: list[dict[str, Any]] = [
    VIEW | {"type": "pinhole", "vertical_field_of_view_degrees": 40},
    VIEW | {"type": "orthographic", "height": 3},
    VIEW | {"type": "panorama"},
    VIEW | {"type": "radiance_meter", "diameter": 0.1, "cone_degrees": 2},
    {"type": "irradiance_meter", "position": [1, 2, 3], "normal": [0, 1, 0], "height": 0.5},
    {"type": "intensity_meter", "position": [1, 2, 3], "lamp_radius": 0.5},
]


def as_array(vector: scene_pb2.Vector) -> Any:
    return np.array([vector.x, vector.y, vector.z])


@pytest.mark.parametrize("sensor", SENSORS)
def test_every_sensor_has_an_orthonormal_frame(
    document: dict[str, Any], compiled: Compile, sensor: dict[str, Any]
) -> None:
    found = compiled(document | {"sensor": sensor}).sensor
    right, up, forward = as_array(found.right), as_array(found.up), as_array(found.forward)
    frame = np.stack([right, up, forward])
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.cross(right, up) == pytest.approx(-forward)
    assert as_array(found.position).tolist() == sensor["position"]


def test_meters_have_their_sizes(document: dict[str, Any], compiled: Compile) -> None:
    models = [compiled(document | {"sensor": sensor}).sensor for sensor in SENSORS]
    assert [sensor.model for sensor in models] == [0, 1, 2, 4, 3, 5]
    assert models[1].height == 3
    assert models[3].height == 0.1
    assert models[3].acceptance == pytest.approx(math.radians(1))
    assert models[4].height == 0.5
    assert as_array(models[4].forward).tolist() == [0, 1, 0]
    assert models[5].lamp_radius == 0.5
    assert as_array(models[5].forward).tolist() == [0, -1, 0]
    # Horizontal angles go from right towards up: from x to -z, counter-clockwise seen from above.
    assert as_array(models[5].right).tolist() == [1, 0, 0]
    assert as_array(models[5].up).tolist() == [0, 0, -1]


def test_a_panorama_keeps_its_horizon(document: dict[str, Any], compiled: Compile) -> None:
    found = compiled(document | {"sensor": SENSORS[2]}).sensor
    assert as_array(found.up).tolist() == [0, 1, 0]
    assert as_array(found.forward).tolist() == [0, 0, 1]


def test_an_aperture_has_edges(document: dict[str, Any], compiled: Compile) -> None:
    lens = {"lens_radius": 0.1, "focus_distance": 3, "aperture": {"blades": 6, "rotation_degrees": 90}}
    sensor = compiled(document | {"sensor": SENSORS[0] | lens | {"type": "thin_lens"}}).sensor
    assert sensor.aperture_blades == 6
    assert sensor.aperture_angle == pytest.approx(math.pi / 2)


def test_observer_and_further_responses(document: dict[str, Any], compiled: Compile) -> None:
    document["sensor"] |= {
        "observer": "CIE 1964 10 degree",
        "responses": {"silicon": {"table": [[400, 0], [800, 1]]}, "flat": "red"},
    }
    sensor = compiled(document).sensor
    # CIE 015:2018, table T.5: y10 at 555 nm.
    assert sensor.response_y[555 - 360] == pytest.approx(683 * 0.999115, rel=1e-4)
    assert [response.name for response in sensor.further_responses] == ["flat", "silicon"]
    flat, silicon = (np.array(response.values) for response in sensor.further_responses)
    assert set(flat) == {np.float32(0.3)}
    assert silicon[[0, 240, 470]] == pytest.approx([0, 0.5, 0])


@pytest.mark.parametrize(
    "table",
    [
        [[550.2, 0], [550.3, 1], [550.4, 1], [550.5, 0]],
        [[589.99, 1], [590.0, 1]],
        [[800, 1], [820, 1]],
        [[360, 1], [361.5, 2]],
        [[828.3, 1], [900, 1]],
        [[300, 1], [500.25, 0.5], [700, 3]],
    ],
)
def test_a_response_keeps_its_integral_and_its_centre(
    document: dict[str, Any], compiled: Compile, table: list[list[float]]
) -> None:
    """However narrow or steep; by sums over the visible part of the table in fine steps."""
    document["sensor"]["responses"] = {"filter": {"table": table}}
    [response] = compiled(document).sensor.further_responses
    values, nm = np.array(response.values, dtype=np.float64), np.arange(360.0, 831.0)
    knots = np.array(table)
    edges = np.linspace(max(360.0, knots[0, 0]), min(830.0, knots[-1, 0]), 1_000_001)
    middles, step = (edges[:-1] + edges[1:]) / 2, edges[1] - edges[0]
    fine = np.interp(middles, *knots.T)
    integral = fine.sum() * step
    assert np.trapezoid(values, nm) == pytest.approx(integral, rel=1e-6)
    # Not where the response is cut by the range: half of a hat has its centre elsewhere.
    if edges[0] >= 361 and edges[-1] <= 829:
        assert values @ nm / values.sum() == pytest.approx(middles @ fine * step / integral, abs=1e-4)


def test_a_response_of_whole_nanometres_is_exact(document: dict[str, Any], compiled: Compile) -> None:
    document["sensor"]["responses"] = {"filter": {"table": [[500, 0], [501, 1], [504, 0]]}}
    [response] = compiled(document).sensor.further_responses
    assert response.values[139:146] == pytest.approx([0, 0, 1, 2 / 3, 1 / 3, 0, 0])


@pytest.mark.parametrize(
    ("sensor", "place", "words"),
    [
        ({"type": "fisheye"}, "$.sensor.type", '"pinhole", "thin_lens", "orthographic", "panorama"'),
        (SENSORS[1] | {"height": 0}, "$.sensor.height", "found 0"),
        (SENSORS[4] | {"look_at": [0, 0, 0]}, "$.sensor.normal", "either normal or look_at"),
        (SENSORS[4] | {"normal": [0, 0, 0]}, "$.sensor.normal", "no direction"),
        (SENSORS[4] | {"up": [0, 2, 0]}, "$.sensor.up", "parallel"),
        (SENSORS[5] | {"zero": [0, 3, 0]}, "$.sensor.zero", "parallel to axis"),
        (SENSORS[5] | {"lamp_radius": 0}, "$.sensor.lamp_radius", "found 0"),
        (SENSORS[0] | {"observer": "mine"}, "$.sensor.observer", '"CIE 1931 2 degree", "CIE 1964 10 degree"'),
        (SENSORS[0] | {"responses": {"a": "x"}}, "$.sensor.responses.a", 'no spectrum named "x"'),
        (
            SENSORS[0] | {"responses": {"a": {"table": [[550, 1]]}}},
            "$.sensor.responses.a",
            "zero from 360 to",
        ),
        (
            SENSORS[0] | {"motion": {"placements": [{}, {"scale": 2}]}},
            "$.sensor.motion.placements",
            "no scale",
        ),
    ],
)
def test_a_wrong_sensor_is_told(
    document: dict[str, Any], blobs: BlobStore, sensor: Any, place: str, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        compile_scene(parse_document(json.dumps(document | {"sensor": sensor})), blobs)
    problem = str(caught.value.problems[0])
    assert problem.startswith(f"{place}: ")
    assert words in problem


def test_forward_is_for_sensors_with_a_size(document: dict[str, Any], compiled: Compile) -> None:
    document["tracing"] = {"direction": "forward"}
    for sensor in SENSORS[4:]:
        # Its sphere holds all of the scene.
        wide = {"lamp_radius": 100.0} if sensor["type"] == "intensity_meter" else {}
        assert compiled(document | {"sensor": sensor | wide}).tracing.direction == scene_pb2.DIRECTION_FORWARD
    with pytest.raises(
        InputError, match=r"\$\.tracing\.direction: .*a pinhole has no size; expected \"adjoint\""
    ):
        compiled(document)


@pytest.mark.parametrize("sensor", SENSORS, ids=[sensor["type"] for sensor in SENSORS])
def test_both_directions_are_for_cameras(
    sensor: dict[str, Any], document: dict[str, Any], compiled: Compile
) -> None:
    document |= {"tracing": {"direction": "both"}, "sensor": sensor}
    if not sensor["type"].endswith("_meter"):
        assert compiled(document).tracing.direction == scene_pb2.DIRECTION_BOTH
        return
    with pytest.raises(InputError, match=r'\$\.tracing\.direction: "both" needs a camera, and a .*_meter'):
        compiled(document)


def weights(tracing: scene_pb2.Tracing) -> list[float]:
    return [
        tracing.weight_kernel,
        tracing.weight_luminaires,
        tracing.weight_environment,
        tracing.weight_important,
        tracing.weight_uniform,
    ]


@pytest.mark.parametrize(
    ("mixture", "there", "expected"),
    [
        ({}, (), [0.65, 0.35, 0, 0, 0]),
        ({}, ("environment",), [0.65, 0.175, 0.175, 0, 0]),
        ({}, ("environment", "important_directions"), [0.65, *[0.35 / 3] * 3, 0]),
        ({}, ("distant",), [0.65, 0.175, 0.175, 0, 0]),
        ({"luminaires": 0.65}, ("environment",), [0.5, 0.5, 0, 0, 0]),
        ({"kernel": 1, "environment": 1, "important": 2}, ("environment",), [0.5, 0, 0.5, 0, 0]),
        ({"kernel": 1, "important": 1}, (), [1, 0, 0, 0, 0]),
        ({"kernel": 0, "important": 1}, (), [1, 0, 0, 0, 0]),
        ({"kernel": 1, "uniform": 1}, (), [1 / 2.35, 0.35 / 2.35, 0, 0, 1 / 2.35]),
    ],
)
def test_weights_are_for_what_the_scene_has(
    document: dict[str, Any], compiled: Compile, mixture: Any, there: tuple[str, ...], expected: list[float]
) -> None:
    parts = {
        "environment": {"radiance": 1},
        "distant": [{"direction": [0, 1, 0], "sun": True}],
        "important_directions": [{"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1}}],
    }
    document |= {name: parts[name] for name in there}
    document["tracing"] = {"mixture": mixture}
    assert weights(compiled(document).tracing) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("index", "together", "group"), [("N-BK7", "auto", 4), (1.5, "auto", 4), ("N-BK7", 1, 1), (1.5, 1, 1)]
)
def test_photons_travel_together(
    document: dict[str, Any], compiled: Compile, index: Any, together: Any, group: int
) -> None:
    document["surfaces"][0]["kernel"] = {"type": "dielectric", "index": index}
    document["tracing"] = {"photons_together": together}
    assert compiled(document).tracing.group == group


def test_estimators(document: dict[str, Any], compiled: Compile) -> None:
    assert compiled(document).tracing.estimator == scene_pb2.ESTIMATOR_TWO_PHOTONS
    document["tracing"] = {"estimator": "split", "split_vertices": 3}
    tracing = compiled(document).tracing
    assert (tracing.estimator, tracing.split_vertices) == (scene_pb2.ESTIMATOR_SPLIT, 3)
    document["tracing"]["photons_together"] = 2
    with pytest.raises(InputError, match=r"photons_together: expected one of \"auto\", 1, 4, found 2"):
        compiled(document)
