"""Mistakes in media and interiors: each is reported with its place."""

import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError

from tests.scene.conftest import Document
from tests.scene.test_media import with_media


def problems(document: Document, blobs: BlobStore) -> list[str]:
    with pytest.raises(InputError) as caught:
        compile_scene(check_document(document), blobs)
    return [str(problem) for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"media": {"fog": {}}}, "$.media.fog", 'expected either "preset"'),
        ({"media": {"fog": {"preset": "air", "scattering": 1}}}, "$.media.fog", "expected either"),
        ({"media": {"fog": {"preset": "mist"}}}, "$.media.fog.preset", '"coastal haze"'),
        ({"media": {"fog": {"scattering": -1}}}, "$.media.fog.scattering", "must be at least 0"),
        ({"media": {"fog": {"scattering": 1e21}}}, "$.media.fog.scattering", "must be at most 1e+20"),
        ({"media": {"fog": {"scattering": {"blackbody": 3000}}}}, "$.media.fog.scattering", "a radiance"),
        (
            {"media": {"fog": {"scattering": {"rgb": [1, 0, 0], "luminance": 4}}}},
            "$.media.fog.scattering",
            "luminance",
        ),
        ({"media": {"fog": {"scattering": 1, "density": -1}}}, "$.media.fog.density", "at least 0"),
        ({"media": {"fog": {"scattering": 1, "density": {}}}}, "$.media.fog.density", '"scale_height"'),
        (
            {"media": {"fog": {"scattering": 1, "density": {"scale_height": 0}}}},
            "$.media.fog.density.scale_height",
            "at least",
        ),
        (
            {"media": {"fog": {"scattering": 1, "density": {"layers": [[0, 1], [0, 2]]}}}},
            "$.media.fog.density.layers[1][0]",
            "altitudes must increase",
        ),
        (
            {"media": {"fog": {"scattering": 1, "density": {"scale_height": 1, "above": {"up": [0, 0, 0]}}}}},
            "$.media.fog.density.above.up",
            "no length",
        ),
        (
            {"media": {"fog": {"absorption": 1, "phase": {"type": "isotropic"}}}},
            "$.media.fog.phase",
            "no scat",
        ),
        ({"media": {"fog": {"preset": "air", "phase": {"type": "isotropic"}}}}, "$.media.fog.phase", "own"),
        ({"media": {"fog": {"scattering": 1, "phase": {"type": "mist"}}}}, "$.media.fog.phase.type", '"mie"'),
        (
            {"media": {"fog": {"scattering": 1, "phase": {"type": "henyey_greenstein", "g": 1}}}},
            "$.media.fog.phase.g",
            "less than 1",
        ),
        (
            {"media": {"fog": {"scattering": 1, "phase": {"type": "rayleigh", "depolarisation": 1}}}},
            "$.media.fog.phase.depolarisation",
            "[0, 1)",
        ),
        (
            {
                "media": {
                    "fog": {
                        "scattering": 1,
                        "phase": {"type": "tabulated", "cosines": [-1, 0.9], "values": [[1, 1]]},
                    }
                }
            },
            "$.media.fog.phase.cosines",
            "from -1 to 1",
        ),
        (
            {
                "media": {
                    "fog": {
                        "scattering": 1,
                        "phase": {"type": "tabulated", "cosines": [-1, 1], "values": [[0, 0]]},
                    }
                }
            },
            "$.media.fog.phase.values[0]",
            "all values are zero",
        ),
        (
            {"media": {"fog": {"scattering": 1, "emission_scale": 2}}},
            "$.media.fog.emission_scale",
            "temperature",
        ),
        (
            {"media": {"fog": {"droplets": {"mode_radius": 5e-4, "alpha": 6}}}},
            "$.media.fog.droplets.mode_radius",
            "at most 57.3",
        ),
        ({"unbounded_media": ["mist"]}, "$.unbounded_media[0]", 'expected one of "fog"'),
        ({"unbounded_media": ["fog", "fog"]}, "$.unbounded_media[1]", "named twice"),
    ],
)
def test_a_mistake_is_told_with_its_place(
    document: Document, blobs: BlobStore, change: Document, place: str, words: str
) -> None:
    document = with_media(document, fog={"scattering": 1}) | change
    [problem] = problems(document, blobs)
    assert problem.startswith(f"{place}: "), problem
    assert words in problem


def test_interiors_are_checked(document: Document, blobs: BlobStore) -> None:
    document = with_media(document, fog={"scattering": 1})
    ball = document["surfaces"][3]
    ball["interior"] = {"media": ["mist"]}
    assert problems(document, blobs) == [
        '$.surfaces[3].interior.media[0]: no medium named "mist"; expected one of "fog"'
    ]
    ball["interior"] = {"media": []}
    assert problems(document, blobs) == ["$.surfaces[3].interior.media: expected at least 1 entries, found 0"]
    ball["interior"] = {"media": ["fog"], "priority": 2}
    ball["kernel"] = {"type": "dielectric", "index": 1.5}
    [problem] = problems(document, blobs)
    assert problem.startswith("$.surfaces[3].interior.priority: the dielectric kernel has a priority")
    del ball["interior"], ball["kernel"]
    [problem] = problems(document, blobs)
    assert problem.startswith("$.surfaces[3].kernel: missing; expected a kernel, or an interior")
