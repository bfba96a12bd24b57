"""Reduction keeps what makes a scene fail, and nothing else."""

from typing import Any

from tests.crossings.reducing import inlined, reduced


def test_only_what_fails_is_left() -> None:
    whole = {
        "surfaces": [
            {"shape": index, "kernel": {"type": "mask", "kernel": {"type": "x"}}} for index in range(9)
        ],
        "environment": {"radiance": 1.0},
        "sensor": {"type": "pinhole", "motion": {"translate": [1, 2, 3]}},
    }

    def fails(candidate: Any) -> bool:
        try:
            return any(each["shape"] == 7 for each in candidate["surfaces"]) and bool(
                candidate["sensor"]["type"]
            )
        except (KeyError, TypeError):
            return False

    found = reduced(whole, fails, 10.0)
    assert found == {"surfaces": [{"shape": 7}], "sensor": {"type": "pinhole"}}


def test_bodies_stay_closed() -> None:
    """A mesh is one thing, for which a sphere may stand."""
    triangles = [[0, 1, 2], [0, 2, 1]]
    mesh = {"type": "mesh", "vertices": [[0, 0, 0], [1, 0, 1], [0, 1, 1]], "triangles": triangles}

    def fails(candidate: Any) -> bool:
        try:
            shape = candidate["surfaces"][0]["shape"]
            assert shape.get("triangles", triangles) == triangles
            if shape["type"] == "sphere":
                return len(shape["centre"]) == 3 and shape["radius"] > 0.0
            return bool(shape["vertices"] and shape["triangles"])
        except (KeyError, TypeError, AttributeError, IndexError):
            return False

    found = reduced({"surfaces": [{"shape": mesh, "motion": 1}]}, fails, 10.0)
    assert found["surfaces"][0].keys() == {"shape"}
    assert found["surfaces"][0]["shape"] == {"type": "sphere", "centre": [0.5, 0.5, 0.5], "radius": 0.4}


def test_it_ends_after_so_many_tries() -> None:
    asked = []

    def fails(candidate: Any) -> bool:
        asked.append(candidate)
        return False

    whole = {"surfaces": [{"name": index} for index in range(100)]}
    assert reduced(whole, fails, 10.0, 7) == whole
    assert len(asked) == 7


def test_inner_kernels_stand_for_the_whole() -> None:
    whole = {
        "kernel": {"type": "mask", "opacity": 0.5, "kernel": {"type": "blend", "first": {"type": "glass"}}}
    }
    found = reduced(whole, lambda candidate: "glass" in repr(candidate), 10.0)
    assert found == {"kernel": {"type": "glass"}}


def test_names_are_written_where_they_are_used() -> None:
    document = {
        "spectra": {"red": 0.5},
        "kernels": {"wall": {"reflectance": "red"}},
        "surfaces": [{"kernel": "wall"}],
    }
    assert inlined(document) == {"surfaces": [{"kernel": {"reflectance": 0.5}}]}
