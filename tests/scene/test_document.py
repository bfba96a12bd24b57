"""Documents are read, and errors in them are reported with their places and the valid choices."""

import json
from typing import Any

import pytest
from nocturne_scene import limits
from nocturne_scene.document import bounds
from nocturne_scene.document.read import parse_document
from nocturne_scene.errors import InputError

_DELETE = object()


def _spoil(document: dict[str, Any], steps: tuple[str | int, ...], value: Any) -> None:
    inner: Any = document
    for step in steps[:-1]:
        inner = inner[step]
    if value is _DELETE:
        del inner[steps[-1]]
    else:
        inner[steps[-1]] = value


def problems_of(text: str | bytes) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_document(text)
    return [str(problem) for problem in caught.value.problems]


def test_a_valid_document_is_read_with_its_defaults(document: dict[str, Any]) -> None:
    scene = parse_document(json.dumps(document).encode())
    assert scene.tracing.photons_together == "auto"
    assert scene.sensor.wavelengths == "response"
    assert len(scene.surfaces) == 3


_KERNEL = ("surfaces", 1, "kernel")
_SPHERE = ("surfaces", 0, "shape")
_MESH = ("surfaces", 2, "shape")
_QUAD = ("surfaces", 1, "shape")
_RADIANCE = ("surfaces", 1, "luminaire", "radiance")
_TABLE = ("spectra", "white", "table")


@pytest.mark.parametrize(
    ("steps", "value", "place", "words"),
    [
        # names and choices
        (
            (*_KERNEL, "reflectance"),
            "whit",
            "$.surfaces[1].kernel.reflectance",
            'no spectrum named "whit"; expected one of "white", "red"',
        ),
        (
            ("surfaces", 0, "kernel"),
            "x",
            "$.surfaces[0].kernel",
            'no kernel named "x"; expected one of "white"',
        ),
        (("kernels", "white", "reflectance"), "x", "$.kernels.white.reflectance", 'no spectrum named "x"'),
        (_RADIANCE, "x", "$.surfaces[1].luminaire.radiance", 'no spectrum named "x"'),
        ((*_KERNEL, "type"), "mirror", "$.surfaces[1].kernel.type", 'expected one of "lambertian"'),
        ((*_SPHERE, "type"), "cube", "$.surfaces[0].shape.type", 'expected one of "mesh", "quad", "sphere"'),
        ((*_SPHERE, "type"), _DELETE, "$.surfaces[0].shape.type", "missing"),
        (
            ("sensor", "wavelengths"),
            "all",
            "$.sensor.wavelengths",
            'expected one of "response", "uniform", found "all"',
        ),
        (
            _RADIANCE,
            {"illuminant": "D66"},
            "$.surfaces[1].luminaire.radiance.illuminant",
            'no illuminant named "D66"; expected one of "A", "C", "D50", "D55", "D65", "D75", "E"',
        ),
        (
            _RADIANCE,
            {"tabel": []},
            "$.surfaces[1].luminaire.radiance",
            '"constant", "table", "blackbody", "illuminant"',
        ),
        (("nocturne",), 2, "$.nocturne", "expected 1, found 2"),
        # unknown and missing fields
        (("sensors",), {}, "$.sensors", 'unknown field; expected one of "nocturne", "name"'),
        (
            (*_SPHERE, "size"),
            1,
            "$.surfaces[0].shape.size",
            'unknown field; expected one of "type", "centre", "radius"',
        ),
        (
            (*_MESH, "asset"),
            "a.ply",
            "$.surfaces[2].shape.vertices",
            'expected one of "type", "asset", "format"',
        ),
        (
            (*_KERNEL, "colour"),
            1,
            "$.surfaces[1].kernel.colour",
            'unknown field; expected one of "type", "reflectance"',
        ),
        (
            ("kernels", "white", "colour"),
            1,
            "$.kernels.white.colour",
            'expected one of "type", "reflectance"',
        ),
        (
            ("surfaces", 1, "luminaire", "power"),
            1,
            "$.surfaces[1].luminaire.power",
            '"radiance", "lumens"',
        ),
        (("spectra", "white", "unit"), 1, "$.spectra.white.unit", '"table", "outside", "luminance"'),
        (("sensor",), _DELETE, "$.sensor", "missing"),
        (("spectra", "a/b"), 1, '$.spectra["a/b"]', "expected text of the form"),
        (("spectra", "<name>"), 1, '$.spectra["<name>"]', "expected text of the form"),
        # numbers
        (
            (*_SPHERE, "radius"),
            float("nan"),
            "$.surfaces[0].shape.radius",
            "expected a finite number, found nan",
        ),
        ((*_SPHERE, "radius"), float("inf"), "$.surfaces[0].shape.radius", "expected a finite number"),
        ((*_SPHERE, "radius"), True, "$.surfaces[0].shape.radius", "expected a number, found true"),
        ((*_SPHERE, "radius"), "1", "$.surfaces[0].shape.radius", 'expected a number, found "1"'),
        (
            (*_SPHERE, "radius"),
            10**400,
            "$.surfaces[0].shape.radius",
            "expected a number, found a very large number",
        ),
        ((*_SPHERE, "radius"), -1, "$.surfaces[0].shape.radius", "found -1"),
        ((*_SPHERE, "radius"), 0, "$.surfaces[0].shape.radius", "found 0"),
        (("surfaces", 0, "scale"), 0, "$.surfaces[0].scale", "found 0"),
        ((*_SPHERE, "centre"), [0, 0], "$.surfaces[0].shape.centre[2]", "missing"),
        ((*_SPHERE, "centre"), [0, 0, 0, 0], "$.surfaces[0].shape.centre", "at most 3"),
        # shapes
        ((*_MESH, "vertices", 1), [0, float("nan"), 0], "$.surfaces[2].shape.vertices[1][1]", "finite"),
        (
            (*_MESH, "triangles", 1),
            [1, 4, 2],
            "$.surfaces[2].shape.triangles[1][1]",
            "vertex 4 does not exist",
        ),
        ((*_MESH, "triangles", 1), [1, -1, 2], "$.surfaces[2].shape.triangles[1][1]", "at least 0"),
        ((*_QUAD, "edge_v"), [2, 0, 0], "$.surfaces[1].shape.edge_v", "no area"),
        ((*_QUAD, "edge_u"), [0, 0, 0], "$.surfaces[1].shape.edge_u", "no length"),
        (_MESH, {"type": "mesh", "asset": "a.foo"}, "$.surfaces[2].shape.format", '"obj", "ply"'),
        (_MESH, {"type": "mesh", "asset": "sha256:" + 64 * "0"}, "$.surfaces[2].shape.format", "missing"),
        (_MESH, {"type": "mesh", "asset": "sha256:0", "format": "ply"}, "$.surfaces[2].shape.asset", "64"),
        # the sensor
        (("sensor", "look_at"), [0, 0, -2], "$.sensor.look_at", "same point as position"),
        (("sensor", "up"), [0, 0, -1], "$.sensor.up", "parallel"),
        (("sensor", "up"), [0, 0, 0], "$.sensor.up", "no length"),
        (
            ("sensor", "vertical_field_of_view_degrees"),
            180,
            "$.sensor.vertical_field_of_view_degrees",
            "less than 180",
        ),
        (("sensor", "type"), "thin_lens", "$.sensor.lens_radius", "missing"),
        # spectra
        ((*_TABLE, 1, 0), 400, "$.spectra.white.table[1][0]", "400 nm follows 400 nm"),
        ((*_TABLE, 1, 1), 1.5, "$.kernels.white.reflectance", 'spectrum "white" is 1.5 at .table[1][1]'),
        ((*_KERNEL, "reflectance"), 1.5, "$.surfaces[1].kernel.reflectance", "lies in [0, 1]"),
        (
            (*_KERNEL, "reflectance"),
            {"blackbody": 3000},
            "$.surfaces[1].kernel.reflectance",
            "expected a reflectance",
        ),
        (_RADIANCE, -1, "$.surfaces[1].luminaire.radiance", "at least 0"),
        (
            _RADIANCE,
            {"table": [[400, 1], [500, -1]]},
            "$.surfaces[1].luminaire.radiance.table[1][1]",
            "at least 0",
        ),
        (_RADIANCE, {"illuminant": "D65"}, "$.surfaces[1].luminaire.radiance", "add its luminance"),
        (_RADIANCE, {"blackbody": 0}, "$.surfaces[1].luminaire.radiance.blackbody", "more than 0"),
        # tracing
        (("tracing",), {"h": 0}, "$.tracing.h", "more than 0"),
        (("tracing",), {"maximum_depth": 0}, "$.tracing.maximum_depth", "at least 1"),
        (("tracing",), {"maximum_depth": 100_001}, "$.tracing.maximum_depth", "at most 100000"),
        (("tracing",), {"maximum_depth": 1.5}, "$.tracing.maximum_depth", "whole number"),
        (("tracing",), {"mixture": {"kernel": -1}}, "$.tracing.mixture.kernel", "at least 0"),
        (
            ("tracing",),
            {"mixture": {"kernel": 0, "luminaires": 0}},
            "$.tracing.mixture",
            "all weights are zero",
        ),
        (("tracing",), {"seed": 2**64}, "$.tracing.seed", "less than"),
        # the whole
        (("surfaces",), [], "$.surfaces", "at least 1"),
        (("surfaces", 1, "luminaire"), _DELETE, "$.surfaces", "no surface has a luminaire"),
        (("surfaces",), {}, "$.surfaces", "expected a list, found an object"),
        (("name",), "\ud800", "$.name", "Unicode"),
    ],
)
def test_a_mistake_is_told_with_its_place(
    document: dict[str, Any], steps: tuple[str | int, ...], value: Any, place: str, words: str
) -> None:
    _spoil(document, steps, value)
    [problem, *_] = problems_of(json.dumps(document))
    assert problem.startswith(f"{place}: ")
    assert words in problem


def test_all_mistakes_are_told_at_once(document: dict[str, Any]) -> None:
    document["surfaces"][0]["shape"]["radius"] = -1
    document["surfaces"][1]["kernel"]["reflectance"] = "whit"
    document["sensor"]["up"] = [0, 0, 1]
    places = [problem.split(": ")[0] for problem in problems_of(json.dumps(document))]
    assert places == ["$.sensor.up", "$.surfaces[0].shape.radius", "$.surfaces[1].kernel.reflectance"]


def test_the_list_of_mistakes_is_bounded(document: dict[str, Any]) -> None:
    document["surfaces"] *= 100
    for surface in document["surfaces"]:
        surface["kernel"] = "x"
    assert len(problems_of(json.dumps(document))) == bounds.PROBLEMS


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "$: not JSON"),
        ('{"nocturne": 1,', "$: not JSON"),
        ("[1]", "$: expected an object"),
        (b'{"name": "\xff"}', "$: not UTF-8: byte 10"),
        ("[" * 10_000, "$: nested deeper than 64 levels"),
        ('{"a":' * 10_000 + "1" + "}" * 10_000, "$: nested deeper than 64 levels"),
        ('{"a":' * 65 + "1" + "}" * 65, "$.a.a.a.a.a.a.a.a...: nested deeper than 64 levels"),
        ("1" * 5000, "$: not JSON: a number has too many digits"),
        ('{"nocturne": 1, "nocturne": 1}', "$.nocturne: this key stands more than once"),
        ('{"sensor": {"up": 1, "up": 2}}', "$.sensor.up: this key stands more than once"),
    ],
)
def test_text_that_is_no_document(text: str | bytes, words: str) -> None:
    assert problems_of(text)[0].startswith(words)


@pytest.mark.parametrize("opening", ["[", "[]", '"'])
def test_a_long_text_is_refused_before_it_is_parsed(opening: str) -> None:
    text = (opening * (100 * 2**20))[: 100 * 2**20]
    assert str(limits.MAX_SCENE_BYTES) in problems_of(text)[0]


def test_characters_count_as_the_bytes_they_take() -> None:
    text = '{"name": "' + "\N{EURO SIGN}" * (limits.MAX_SCENE_BYTES // 3 + 1) + '"}'
    assert "at most" in problems_of(text)[0]
