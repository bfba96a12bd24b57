"""Which simplifications a document allows, and what each does to it."""

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.compile.placement import motion_steps, placements_of
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError
from nocturne_scene.simplify.candidates import candidates

from tests.pictures import write_exr

Document = dict[str, Any]


def no_files(asset: str) -> Path:
    raise AssertionError(f"nobody should ask for {asset}")


def names(document: Document, find: Any = no_files) -> list[str]:
    return [each.name for each in candidates(document, find)]


def without(document: Document, name: str, find: Any = no_files) -> Document:
    """The document after one simplification, which is valid and leaves the original as it was."""
    before = deepcopy(document)
    (found,) = (each for each in candidates(document, find) if each.name == name)
    simpler = found.applied(document)
    assert document == before
    check_document(simpler)
    return simpler


def test_a_medium_leaves_every_body_it_is_in(document: Document) -> None:
    simpler = without(document, 'without medium "fog"')
    assert simpler["surfaces"][1]["interior"]["media"] == ["haze"]
    assert "interior" not in simpler["surfaces"][2]
    assert simpler["surfaces"][2]["kernel"] == "glass"


def test_what_only_bounded_a_medium_goes_with_it(document: Document) -> None:
    document["surfaces"][1]["interior"]["media"] = ["haze"]
    simpler = without(document, 'without medium "haze"')
    assert [surface["shape"]["type"] for surface in simpler["surfaces"]] == ["quad", "sphere"]


def test_a_boundary_that_shines_stays(document: Document) -> None:
    document["surfaces"][1] |= {
        "interior": {"media": ["haze"]},
        "luminaire": {"radiance": {"blackbody": 999}},
    }
    simpler = without(document, 'without medium "haze"')
    assert simpler["surfaces"][1]["kernel"] == {"type": "null"}


def test_media_of_groups_and_of_all_space_are_left_out(document: Document) -> None:
    document["unbounded_media"] = ["spare"]
    document["groups"] = {"ball": [document["surfaces"].pop(2)]}
    document["instances"] = [{"group": "ball"}]
    assert without(document, 'without medium "spare"')["unbounded_media"] == []
    assert "interior" not in without(document, 'without medium "fog"')["groups"]["ball"][0]


def test_media_that_nothing_uses_are_no_part(document: Document) -> None:
    assert 'without medium "spare"' not in names(document)


def test_the_only_light_is_not_left_out(document: Document) -> None:
    document["media"]["haze"]["temperature"] = {"asset": "sha256:" + "0" * 64, "grid": "heat"}
    assert 'without medium "haze"' in names(document)
    del document["surfaces"][0]["luminaire"]
    assert 'without medium "haze"' not in names(document)


def test_parts_of_an_atmosphere(document: Document) -> None:
    document["atmosphere"] = {"ozone": {}, "aerosol": {"medium": "spare", "optical_depth": 0.1}}
    found = names(document)
    assert {f"without the atmosphere's {part}" for part in ("air", "ozone", "aerosol")} < set(found)
    assert without(document, "without the atmosphere's air")["atmosphere"]["air"] is None
    assert "aerosol" not in without(document, 'without medium "spare"')["atmosphere"]
    assert "atmosphere" not in without(document, "without the atmosphere")
    document["atmosphere"] = {}
    assert "without the atmosphere's air" not in names(document)


@pytest.mark.parametrize(
    ("index", "expected"),
    [
        # Schott's data sheet: n_D 1.51673.
        ("N-BK7", 1.51673),
        ({"cauchy": [1.5, 0.01]}, 1.5 + 0.01 / 0.58929**2),
        ({"table": [[489.29, 1.6], [689.29, 1.4]]}, 1.5),
        # The Sellmeier formula by hand: n^2 = 1 + l^2 / (l^2 - 0.01).
        (
            {"sellmeier": {"b": [1, 0, 0], "c": [0.01, 0, 0]}},
            (1 + 0.58929**2 / (0.58929**2 - 0.01)) ** 0.5,
        ),
    ],
)
def test_dispersion_becomes_the_index_at_sodium(document: Document, index: Any, expected: float) -> None:
    document["kernels"]["glass"]["index"] = index
    document["kernels"]["gold"] = {"type": "conductor", "index": "Au"}
    simpler = without(document, "one index of refraction, at 589.29 nm")
    assert simpler["kernels"]["glass"]["index"] == pytest.approx(expected, abs=5e-6)
    assert simpler["kernels"]["gold"]["index"] == "Au"


def test_one_index_is_as_simple_as_can_be(document: Document) -> None:
    document["kernels"]["glass"]["index"] = 1.5
    assert not [name for name in names(document) if "index" in name]


@pytest.fixture
def texture(tmp_path: Path) -> Any:
    """Two texels, red and dark grey, and what finds the file."""
    values = np.array([[[0.8, 0.2, 0.0], [0.2, 0.2, 0.2]]])
    file = write_exr(tmp_path / "texture.exr", values, "RGB")
    return {"asset": "sha256:" + "1" * 64}, lambda _: file


def test_textures_become_their_means(document: Document, texture: Any) -> None:
    picture, find = texture
    luminances = np.array([0.2126 * 0.8 + 0.7152 * 0.2, 0.2])
    use = {"texture": "stripes"}
    document["textures"] = {"stripes": picture}
    document["spectra"] = {"lamp": {"blackbody": 3000, "luminance": 100}}
    document["surfaces"][0]["kernel"]["reflectance"] = use
    document["surfaces"][0]["luminaire"]["radiance"] = {**use, "grey": True, "spectrum": "lamp"}
    document["kernels"]["glass"]["roughness"] = {**use, "gain": 4.0, "bias": 0.1}
    document["surfaces"][2]["bump_map"] = {**use, "height": 0.1}
    document["kernels"]["plain"] = {"type": "lambertian", "reflectance": {**use, "spectrum": 0.5}}
    simpler = without(document, "textures by their means", find)
    assert simpler["surfaces"][0]["kernel"]["reflectance"]["rgb"] == pytest.approx([0.5, 0.2, 0.1])
    assert simpler["kernels"]["glass"]["roughness"] == pytest.approx(
        np.minimum(4 * luminances + 0.1, 1).mean()
    )
    radiance = simpler["surfaces"][0]["luminaire"]["radiance"]
    assert radiance == {"blackbody": 3000, "luminance": pytest.approx(100 * luminances.mean())}
    # No spectrum expresses coloured texels times a spectrum.
    assert simpler["kernels"]["plain"] == document["kernels"]["plain"]
    assert "bump_map" in simpler["surfaces"][2]
    assert "bump_map" not in without(document, "without maps of normals and heights", find)["surfaces"][2]


def test_an_environment_becomes_its_mean_over_directions(document: Document, tmp_path: Path) -> None:
    """Bright within 30 degrees of `up`, black elsewhere: a part (1 - cos 30) / 2 of all directions."""
    values = np.zeros((6, 12, 3))
    values[0] = 2.0, 1.0, 1.0
    file = write_exr(tmp_path / "map.exr", values, "RGB")
    document["environment"] = {"asset": "sha256:" + "2" * 64, "luminance": 10}
    simpler = without(document, "the environment by its mean", lambda _: file)
    part = (1 - np.cos(np.radians(30))) / 2
    radiance = simpler["environment"]["radiance"]
    assert radiance["rgb"] == pytest.approx([1, 0.5, 0.5])
    assert radiance["luminance"] == pytest.approx(10 * part * (2 * 0.2126 + 0.7152 + 0.0722))


def test_nothing_moves_from_the_middle_of_the_shutters_time(document: Document) -> None:
    turn = {"axis": [0, 0, 1], "degrees": 180, "about": [1, 0, 0]}
    document["surfaces"][2]["motion"] = {"rotate": turn, "translate": [0, 0, 4]}
    document["sensor"]["motion"] = {"translate": [2, 0, 0]}
    checked = check_document(without(document, "nothing moves"))
    (placed,) = placements_of(checked.surfaces[2])
    # Half of a half turn about (1, 0): the origin comes to (1, -1).
    assert placed.points(np.zeros(3)) == pytest.approx([1, -1, 2])
    (sensor,) = motion_steps(checked.sensor.motion)
    assert sensor.points(np.zeros(3)) == pytest.approx([1, 0, 0])


def test_given_placements_freeze_in_the_middle_one(document: Document) -> None:
    steps = [{"translate": [0, 0, 0]}, {"translate": [5, 0, 0], "scale": 2}, {"translate": [6, 0, 0]}]
    document["surfaces"][2]["motion"] = {"placements": steps}
    checked = check_document(without(document, "nothing moves"))
    (placed,) = placements_of(checked.surfaces[2])
    assert placed.points(np.array([1.0, 0, 0])) == pytest.approx([7, 0, 0])


def test_instances_that_look_smallest_go_first(document: Document) -> None:
    """Apparent sizes: 0.1, 0.4, 0.05 (far away), 0.2 (in a group of a group)."""
    document["groups"] = {
        "ball": [{"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1}, "kernel": "glass"}],
        "half": [{"group": "ball", "scale": 0.5}],
    }
    document["instances"] = [
        {"group": "ball", "translate": [0, 0, 10], "name": "middle"},
        {"group": "ball", "translate": [0, 0, 10], "scale": 4, "name": "large"},
        {"group": "ball", "translate": [0, 0, 20], "name": "far"},
        {"group": "half", "translate": [0, 0, 2.5], "name": "near"},
    ]
    simpler = without(document, "without the 50% of the instances that look smallest")
    assert [each["name"] for each in simpler["instances"]] == ["large", "near"]
    simpler = without(document, "without the 90% of the instances that look smallest")
    assert [each["name"] for each in simpler["instances"]] == ["large"]


def test_ways_to_trace(document: Document) -> None:
    document["tracing"] = {"estimator": "split", "split_vertices": 2, "maximum_depth": 8}
    found = {each.name: each for each in candidates(document, no_files)}
    depths = [name for name, each in found.items() if each.kind == "depth"]
    assert depths == ["at most 2 interactions", "at most 4 interactions"]
    exact = [name for name, each in found.items() if each.exact]
    assert exact == [
        "roulette from the first interaction",
        "two photons at a vertex instead of splits",
        "one photon at a vertex",
    ]
    assert without(document, "one photon at a vertex")["tracing"] == {
        "estimator": "mixture",
        "maximum_depth": 8,
    }


def test_forward_photons_are_left_out(document: Document) -> None:
    document["sensor"] = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, 1], "height": 1}
    document["tracing"] = {"direction": "forward"}
    simpler = without(document, "adjoint photons instead of forward ones")
    assert simpler["tracing"]["direction"] == "adjoint"


def test_simplifications_join(document: Document) -> None:
    chosen = [each for each in candidates(document, no_files) if not each.kind]
    for each in chosen:
        document = each.applied(document)
    check_document(document)
    assert names(document) == [
        each for each in names(document) if "medium" not in each and "index" not in each
    ]


def test_a_wrong_document_is_refused(document: Document) -> None:
    document["surfaces"][0]["colour"] = "red"
    with pytest.raises(InputError):
        candidates(document, no_files)
