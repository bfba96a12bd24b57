"""Glass within glass: boundaries of Mitsuba and pbrt depend on their own two indices alone."""

from pathlib import Path
from typing import Any

import pytest

from tests.scene.formats.mitsuba_import import imported
from tests.scene.formats.test_mitsuba_export import export
from tests.scene.formats.test_pbrt import imported as imported_pbrt

AIR = 1.000277


def _ball(radius: float, bsdf: str, more: str = "") -> str:
    return f'<shape type="sphere"><float name="radius" value="{radius}"/>{bsdf}{more}</shape>'


def _glass(inside: float, outside: float | None = None) -> str:
    around = "" if outside is None else f'<float name="ext_ior" value="{outside}"/>'
    return f'<bsdf type="dielectric"><float name="int_ior" value="{inside}"/>{around}</bsdf>'


def _kernels(document: dict[str, Any]) -> list[Any]:
    return [surface["kernel"] for surface in document["surfaces"]]


def test_a_bubble_is_between_its_own_indices(tmp_path: Path) -> None:
    bubble = _ball(0.5, _glass(1.0, 1.31))
    document, found = imported(tmp_path, _ball(1.0, _glass(1.31)) + bubble)
    ice, air = _kernels(document)
    assert ice == {"type": "dielectric", "index": pytest.approx(1.31 / AIR), "outside": 1.0}
    assert air == {"type": "dielectric", "index": 1.0, "outside": 1.31}
    assert not any("ratio" in str(note) for note in found.notes)


def test_balls_apart_are_bodies(tmp_path: Path) -> None:
    moved = '<transform name="to_world"><translate x="3"/></transform>'
    document, _ = imported(tmp_path, _ball(1.0, _glass(1.31)) + _ball(0.5, _glass(1.5), moved))
    assert all("outside" not in kernel for kernel in _kernels(document))


def test_a_shared_glass_stays_one(tmp_path: Path) -> None:
    glass = _glass(1.5).replace("<bsdf ", '<bsdf id="glass" ')
    document, _ = imported(
        tmp_path, f"{glass}" + _ball(1, '<ref id="glass"/>') + _ball(0.5, '<ref id="glass"/>')
    )
    assert _kernels(document) == ["glass", "glass"]
    assert document["kernels"]["glass"]["outside"] == 1.0


def test_what_holds_a_medium_is_a_body(tmp_path: Path) -> None:
    fog = '<medium name="interior" type="homogeneous"><float name="sigma_t" value="1"/></medium>'
    document, found = imported(tmp_path, _ball(1.0, _glass(1.5, 1.33), fog))
    assert _kernels(document) == [{"type": "dielectric", "index": pytest.approx(1.5 / 1.33)}]
    assert any("became one of their ratio" in str(note) for note in found.notes)


def test_a_bubble_of_pbrt(tmp_path: Path) -> None:
    ball = 'Material "dielectric" "float eta" [{}] Shape "sphere" "float radius" [{}]\n'
    document, _ = imported_pbrt(tmp_path, ball.format(1.31, 1.0) + ball.format(0.763, 0.5))
    named = document.get("kernels", {})
    kernels = [
        named.get(kernel, kernel) if isinstance(kernel, str) else kernel for kernel in _kernels(document)
    ]
    found = [kernel for kernel in kernels if kernel["type"] == "dielectric"]
    assert found == [{"type": "dielectric", "index": index, "outside": 1.0} for index in (1.31, 0.763)]


def test_both_indices_are_exported(tmp_path: Path) -> None:
    kernel = {"type": "dielectric", "index": 1.0, "outside": 1.31}
    around = {"type": "dielectric", "index": 1.31, "outside": 1.0}
    balls = [
        {"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": radius}, "kernel": each}
        for radius, each in ((1.0, around), (0.5, kernel))
    ]
    scene, _ = export(tmp_path, *balls)
    found = [
        [float(each.get("value", "")) for each in glass.iter("float")]
        for glass in scene.iter("bsdf")
        if glass.get("type") == "dielectric"
    ]
    assert found == [pytest.approx([1.31, 1.0]), pytest.approx([1.0, 1.31])]
