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
