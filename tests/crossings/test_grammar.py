"""Everything that the scene language has is made by the grammar, or is in a list with the reason."""

from nocturne_scene.document.read import check_document

from tests.crossings.features import all_features, features_of
from tests.crossings.looking import features
from tests.crossings.scenes import SITUATIONS, scene

_SEEDS = 800

LEFT_OUT = {
    "SceneDocument.note": "text for people",
    "SceneDocument.source": "text for people",
    "Instance.name": "text for people",
    "Measured.format=merl": "a file of 35 MB; it becomes the table that is there",
    "Tracing.seed": "each method has eight",
    # tests/accuracy/test_ray_files.py compares it with each ray's own path.
    **dict.fromkeys(
        [each for each in all_features() if each.startswith(("RayFile", "SceneDocument.ray_files"))],
        "one direction alone brings its light, so that there are no methods to compare",
    ),
    # tests/accuracy/test_daylight_coefficients.py compares them with renders of the same sky.
    **dict.fromkeys(
        [
            each
            for each in all_features()
            if each.startswith(("YearOfDaylight", "WeatherFile", "Meters.daylight"))
        ],
        "coefficients are counted beside an image under an even sky, by one method",
    ),
}


def test_nothing_of_the_language_is_left_out() -> None:
    """A new type, field or word fails here until the grammar has it."""
    made, situations = set[str](), set[str]()
    for each in map(scene, range(_SEEDS)):
        made |= features(each)
        situations |= each.situations
    assert all_features() - made - LEFT_OUT.keys() == set()
    # Reasons that are none any more.
    assert made & LEFT_OUT.keys() == set()
    assert situations == {*SITUATIONS}


def test_the_same_seed_makes_the_same_scene() -> None:
    assert scene(7) == scene(7)
    assert scene(7).document != scene(8).document


def test_features_of_a_document() -> None:
    sphere = {"type": "sphere", "centre": [0, 0, 0], "radius": 1}
    meter = {"type": "irradiance_meter", "position": [0, 0, 2], "normal": [0, 0, 1], "height": 1}
    surface = {"shape": sphere, "kernel": {"type": "conductor", "index": "Ag", "distribution": "ggx"}}
    document = {"nocturne": 1, "sensor": meter, "surfaces": [surface], "environment": {"radiance": 1.0}}
    found = features_of(check_document(document))
    assert {"Sphere", "Sphere.radius", "Conductor.distribution=ggx", "ConstantEnvironment"} <= found
    assert "Conductor.roughness" not in found
