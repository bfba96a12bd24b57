"""Luminaires, environments and discs at infinity have the sizes that were asked for.

One file, though long: it follows compile/lights.py, and all its tests share one scene.
"""

import json
import math
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import parse_document
from nocturne_scene.errors import InputError
from nocturne_scene.photometry import ies as photometric_files
from nocturne_scene.photometry.intensities import Photometry, flux
from nocturne_scene.spectra import sun
from nocturne_scene.spectra.published import visible_wavelengths
from nocturne_scene.textures import environment_maps

from .conftest import Compile, expect_problem


def photometric(blobs: BlobStore) -> str:
    """A lamp with 100 cd straight down, 50 cd sideways, and 200 cd sideways at 90 degrees."""
    rows = np.array([[100.0, 50, 0], [100, 200, 0], [100, 50, 0], [100, 50, 0], [100, 50, 0]])
    photometry = Photometry(np.array([0.0, 90.0, 180.0]), np.array([0.0, 90.0, 180.0, 270.0, 360.0]), rows)
    return f"sha256:{blobs.put(photometric_files.write(photometry))}"


def evaluate(scene: scene_pb2.CompiledScene, index: int) -> Any:
    return spectra.evaluate(scene.spectra[index], visible_wavelengths())


def test_a_cosine_power_is_kept(document: dict[str, Any], compiled: Compile) -> None:
    document["surfaces"][1]["luminaire"]["profile"] = {"cosine_power": 30}
    assert compiled(document).luminaires[0].cosine_power == 30


@pytest.mark.parametrize(
    ("shape", "area", "allowed"),
    [
        ({"type": "quad", "corner": [0, 0, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, 3]}, 6.0, 1e-12),
        ({"type": "sphere", "centre": [0, 0, 0], "radius": 0.5}, math.pi, 1e-12),
        # The area of its triangles: see the document.
        ({"type": "disc", "centre": [0, 0, 0], "normal": [0, 1, 0], "radius": 2}, 4 * math.pi, 1.1e-4),
        ({"type": "box", "minimum": [0, 0, 0], "maximum": [1, 2, 3]}, 22.0, 1e-12),
        (
            {"type": "mesh", "vertices": [[0, 0, 0], [3, 0, 0], [0, 4, 0]], "triangles": [[0, 1, 2]]},
            6.0,
            1e-12,
        ),
    ],
)
@pytest.mark.parametrize("two_sided", [False, True])
@pytest.mark.parametrize("power", [None, 0, 30])
def test_a_flux_comes_to_its_luminance(
    document: dict[str, Any],
    compiled: Compile,
    shape: dict[str, Any],
    area: float,
    allowed: float,
    two_sided: bool,
    power: float | None,
) -> None:
    """L = flux / (area sides integral of cos^(power + 1)): for an ideal diffuse lamp flux / (pi area)."""
    lamp = document["surfaces"][1]
    lamp.update({"shape": shape, "scale": 2.0})
    lamp["luminaire"] = {"radiance": {"illuminant": "A"}, "two_sided": two_sided}
    if power is not None:
        lamp["luminaire"]["profile"] = {"cosine_power": power}
    per_luminance = area * 4 * (1 + two_sided) * 2 * math.pi / ((power or 0) + 2)

    def spectrum(**amount: float) -> scene_pb2.Spectrum:
        scene = compiled({**document, "surfaces": [document["surfaces"][0], with_(lamp, amount)]})
        return scene.spectra[scene.luminaires[0].radiance.spectrum]

    near = pytest.approx(800 / per_luminance, rel=allowed + 1e-6)
    assert spectra.luminance(spectrum(lumens=800)) == near
    watts = spectra.integral(spectrum(watts=9), np.ones(visible_wavelengths().shape))
    assert float(watts) == pytest.approx(9 / per_luminance, rel=allowed + 1e-6)
    exitance = spectra.luminance(spectrum(exitance=500))
    assert exitance == pytest.approx(500 * ((power or 0) + 2) / (2 * math.pi), rel=1e-6)


def with_(lamp: dict[str, Any], amount: dict[str, float]) -> dict[str, Any]:
    return {**lamp, "luminaire": {**lamp["luminaire"], **amount}}


def test_a_lamp_has_one_amount(document: dict[str, Any], blobs: BlobStore) -> None:
    lamp = document["surfaces"][1]
    lamp["luminaire"] = {"radiance": {"illuminant": "A"}, "lumens": 800, "watts": 9}
    expect_problem(document, blobs, "$.surfaces[1].luminaire.watts", "expected one of lumens, watts")
    lamp["luminaire"] = {
        "radiance": {"illuminant": "A"},
        "lumens": 800,
        "profile": {"asset": photometric(blobs)},
    }
    expect_problem(document, blobs, "$.surfaces[1].luminaire.lumens", "scale it by profile.lumens")


def test_a_photometric_file_gives_its_candelas(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    document["surfaces"][1]["luminaire"] = {
        "radiance": {"illuminant": "FL2"},
        "profile": {"asset": photometric(blobs)},
    }
    scene = compiled(document)
    [luminaire] = scene.luminaires
    assert spectra.luminance(scene.spectra[luminaire.radiance.spectrum]) == pytest.approx(1, rel=1e-6)
    profile = luminaire.intensity
    assert list(profile.vertical) == pytest.approx([0, math.pi / 2, math.pi])
    # The bright side is at 90 degrees counter-clockwise seen from above: with y up and x at 0, at -z.
    axis, zero = (np.array([v.x, v.y, v.z]) for v in (profile.axis, profile.zero))
    assert axis.tolist() == [0, -1, 0]
    values = np.array(profile.values).reshape(len(profile.horizontal), 3)
    brightest = profile.horizontal[int(np.argmax(values[:, 1]))]
    towards = math.cos(brightest) * zero + math.sin(brightest) * np.cross(axis, zero)
    assert towards == pytest.approx([0, 0, -1], abs=1e-12)
    assert values.max() == 200


def test_a_photometric_file_can_be_scaled_to_a_flux_and_turns_with_its_surface(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    document["surfaces"][1]["rotate"] = {"axis": [1, 0, 0], "degrees": 90}
    document["surfaces"][1]["luminaire"]["profile"] = {"asset": photometric(blobs), "lumens": 1000}
    profile = compiled(document).luminaires[0].intensity
    assert (profile.axis.x, profile.axis.y, profile.axis.z) == pytest.approx((0, 0, -1))
    candela = np.array(profile.values).reshape(len(profile.horizontal), 3)
    compiled_back = Photometry(np.rad2deg(profile.vertical), np.rad2deg(profile.horizontal), candela)
    assert flux(compiled_back) == pytest.approx(1000, rel=1e-6)


def test_the_sun_lights_the_ground_as_measured_above_the_atmosphere(
    document: dict[str, Any], compiled: Compile
) -> None:
    document["distant"] = [{"direction": [0, 2, 0], "sun": True}]
    scene = compiled(document)
    [disc] = scene.distant_discs
    assert disc.direction.y == 1
    assert math.degrees(disc.half_angle) == pytest.approx(0.2666, abs=1e-4)
    irradiance = evaluate(scene, disc.radiance) * math.pi * math.sin(disc.half_angle) ** 2
    assert irradiance == pytest.approx(sun.irradiance(), rel=1e-6)
    assert not disc.limb_plus


@pytest.mark.parametrize("limb_darkening", [False, True])
@pytest.mark.parametrize("size", [0.02, 5, 170])
def test_an_irradiance_is_that_of_the_whole_disc(
    document: dict[str, Any], compiled: Compile, limb_darkening: bool, size: float
) -> None:
    document["distant"] = [
        {
            "direction": [0, 0, 1],
            "angular_diameter_degrees": size,
            "irradiance": 2.5,
            "limb_darkening": limb_darkening,
        }
    ]
    scene = compiled(document)
    [disc] = scene.distant_discs
    centre = evaluate(scene, disc.radiance)[100]
    # By steps of r = sin(angle) / sin(half angle): the sum of L(mu) cos dOmega.
    r = (np.arange(100_000) + 0.5) / 100_000
    mu = np.sqrt(1 - r**2)
    limb = np.ones_like(mu)
    if limb_darkening:
        signed = [(index, 1) for index in disc.limb_plus], [(index, -1) for index in disc.limb_minus]
        limb = sum(
            sign * evaluate(scene, index)[100] * mu**k
            for terms in signed
            for k, (index, sign) in enumerate(terms)
        )
    irradiance = 2 * math.pi * math.sin(disc.half_angle) ** 2 * np.mean(centre * limb * r)
    assert irradiance == pytest.approx(2.5, rel=1e-4)


def test_an_environment_is_light_enough(document: dict[str, Any], compiled: Compile) -> None:
    del document["surfaces"][1]["luminaire"]
    document["environment"] = {"radiance": {"illuminant": "D65", "luminance": 100}}
    scene = compiled(document)
    assert spectra.luminance(scene.spectra[scene.environment.constant]) == pytest.approx(100, rel=1e-6)
    assert not scene.luminaires
    assert scene.tracing.weight_environment == pytest.approx(0.35)


def even_sky(blobs: BlobStore, tmp_path: Path) -> str:
    """A picture of 8 x 4 pixels, RGB (2, 2, 2), as an asset."""
    pixels = np.full((4, 8, 3), 2.0, dtype=np.float32)
    picture = oiio.ImageBuf(oiio.ImageSpec(8, 4, 3, oiio.FLOAT))
    picture.set_pixels(oiio.ROI(), pixels)
    picture.write(str(tmp_path / "sky.exr"))
    return f"sha256:{blobs.put((tmp_path / 'sky.exr').read_bytes())}"


def test_a_sky_is_made_once_for_all_scenes(
    document: dict[str, Any],
    compiled: Compile,
    blobs: BlobStore,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = []
    convert = environment_maps.convert

    def counted(source: Path, target: BinaryIO, *, points: bool) -> tuple[int, int]:
        made.append(source)
        return convert(source, target, points=points)

    monkeypatch.setattr(environment_maps, "convert", counted)
    document["environment"] = {"asset": even_sky(blobs, tmp_path), "luminance": 50}
    first = compiled(document).environment.map
    document["environment"] |= {"rotate_degrees": 10, "luminance": 70}
    document["sensor"]["position"] = [0, 0, -3]
    assert compiled(document).environment.map.blob == first.blob
    assert len(made) == 1
    blobs.path(first.blob.hex()).unlink()
    assert compiled(document).environment.map.blob == first.blob
    assert blobs.has(first.blob.hex())
    assert len(made) == 2


@pytest.mark.parametrize("text", ["", "7", "[]", '["x", [8, 4]]', '["DIGEST", "nan"]', '["DIGEST", [8]]'])
def test_a_damaged_note_of_a_sky_is_none(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, tmp_path: Path, text: str
) -> None:
    document["environment"] = {"asset": even_sky(blobs, tmp_path)}
    first = compiled(document)
    for note in (blobs.root / "notes").glob("*/*"):
        note.write_text(text.replace("DIGEST", first.environment.map.blob.hex()))
    assert compiled(document) == first


def test_an_environment_map_has_its_frame(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, tmp_path: Path
) -> None:
    asset = even_sky(blobs, tmp_path)
    document["environment"] = {"asset": asset, "luminance": 50, "rotate_degrees": 90}
    scene = compiled(document)
    found = scene.environment.map
    x, y, z = (np.array([v.x, v.y, v.z]) for v in (found.x, found.y, found.z))
    assert z == pytest.approx([0, 1, 0])
    assert x == pytest.approx([-1, 0, 0])  # from -z a quarter to the left
    assert np.cross(x, y) == pytest.approx(z)
    texels = np.frombuffer(blobs.path(found.blob.hex()).read_bytes(), "<f4").reshape(
        found.rows, found.columns, 4
    )
    scale, c0, c1, c2 = texels[1, 3].astype(np.float64)
    at = visible_wavelengths()
    arguments = (c0 * at + c1) * at + c2
    shape = 0.5 + 0.5 * arguments / np.hypot(1, arguments)
    radiance = scale * shape * evaluate(scene, found.spectrum)
    assert 683 * radiance @ spectra.response()[:, 1] / 683 == pytest.approx(2 * 50, rel=1e-3)


def test_what_is_dark_is_dropped_and_told(document: dict[str, Any], blobs: BlobStore) -> None:
    document["environment"] = {"radiance": 0}
    document["distant"] = [{"direction": [0, 1, 0], "radiance": 0}]
    document["important_directions"] = [
        {"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1}, "weight": 0}
    ]
    output = compile_scene(parse_document(json.dumps(document)), blobs)
    assert [line for line in output.dropped if "surfaces" not in line] == [
        "$.environment: emits no visible light",
        "$.distant[0]: emits no visible light",
        "$.important_directions[0]: has no weight",
    ]


def test_important_directions_stand_where_they_are_put(document: dict[str, Any], compiled: Compile) -> None:
    disc = {"type": "disc", "centre": [0, 0, 0], "normal": [0, 0, 1], "radius": 2, "segments": 16}
    document["important_directions"] = [
        {"shape": disc, "translate": [0, 0, 5], "weight": 3},
        {"shape": {"type": "sphere", "centre": [1, 0, 0], "radius": 1}, "scale": 2},
    ]
    scene = compiled(document)
    mesh, sphere = scene.important_shapes
    assert (mesh.mesh.triangle_count, mesh.weight) == (16, 3)
    assert (sphere.sphere.centre.x, sphere.sphere.radius, sphere.weight) == (2, 2, 1)
    assert scene.tracing.weight_important == pytest.approx(0.175)


def test_emission_is_aimed_at_what_is_there(document: dict[str, Any], blobs: BlobStore) -> None:
    """Only photons from luminaires are aimed, and not all of them: light on other paths would be lost."""
    meter = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, 1], "height": 1}
    ball = {"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1}}
    aimed = {"direction": "forward", "aimed_emission": 0.9}

    def compiled(**changes: Any) -> tuple[float, list[str]]:
        output = compile_scene(parse_document(json.dumps(document | {"sensor": meter} | changes)), blobs)
        scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
        return scene.tracing.aimed_emission, [line for line in output.dropped if "aimed" in line]

    assert compiled(important_directions=[ball], tracing=aimed) == (0.9, [])
    place = "$.tracing.aimed_emission"
    nothing = f"{place}: the scene has no important directions"
    assert compiled(tracing=aimed) == (0.0, [nothing])
    adjoint = aimed | {"direction": "adjoint"}
    nobody = f"{place}: no photons start at luminaires"
    assert compiled(important_directions=[ball], tracing=adjoint) == (0.0, [nobody])
    with pytest.raises(InputError, match=r"\$\.tracing\.aimed_emission"):
        compiled(important_directions=[ball], tracing=aimed | {"aimed_emission": 1})


@pytest.mark.parametrize(
    ("tracing", "why"),
    [({"direction": "forward"}, "no photons start"), ({"estimator": "mixture"}, "only the estimator")],
)
def test_pixels_share_where_they_can(
    tracing: dict[str, Any], why: str, document: dict[str, Any], blobs: BlobStore
) -> None:
    meter = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, 1], "height": 1}

    def compiled(**tracing: Any) -> tuple[int, list[str]]:
        changed = document | {"sensor": meter, "tracing": {"sharing": 16} | tracing}
        output = compile_scene(parse_document(json.dumps(changed)), blobs)
        scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
        return scene.tracing.sharing, [line for line in output.dropped if "sharing" in line]

    assert compiled() == (16, [])
    assert compiled(sharing="auto") == (1, [])
    sharing, [dropped] = compiled(**tracing)
    assert sharing == 1
    assert dropped.startswith(f"$.tracing.sharing: {why}")


_LUMINAIRE = ("surfaces", 1, "luminaire")
_BOX = {"type": "box", "minimum": [0, 0, 0], "maximum": [1, 1, 1]}


@pytest.mark.parametrize(
    ("changes", "place", "words"),
    [
        (
            {"luminaire": {"type": "point", "intensity": 1}},
            "$.surfaces[1].luminaire.type",
            "a lamp needs a size",
        ),
        ({"luminaire": {"type": "spot"}}, "$.surfaces[1].luminaire.type", "a lamp needs a size"),
        ({"shape": {"type": "point"}}, "$.surfaces[1].shape.type", "a lamp needs a size"),
        (
            {"luminaire": {"radiance": {"chart_patch": "red"}}},
            "$.surfaces[1].luminaire.radiance",
            "expected a radiance",
        ),
        (
            {"luminaire": {"radiance": {"rgb": [1, 0.5, 0]}}},
            "$.surfaces[1].luminaire.radiance",
            "add its luminance",
        ),
        (
            {"luminaire": {"radiance": 1, "profile": {"power": 2}}},
            "$.surfaces[1].luminaire.profile",
            '"cosine_power", "asset"',
        ),
        (
            {"luminaire": {"radiance": 1, "profile": {"asset": "a.ies"}}},
            "$.surfaces[1].luminaire.profile.asset",
            "no paths",
        ),
    ],
)
def test_a_wrong_luminaire_is_told(
    document: dict[str, Any], blobs: BlobStore, changes: dict[str, Any], place: str, words: str
) -> None:
    document["surfaces"][1] |= changes
    expect_problem(document, blobs, place, words)


@pytest.mark.parametrize(
    ("changes", "place", "words"),
    [
        ({"lights": [{"type": "point"}]}, "$.lights", "a lamp needs a size"),
        (
            {"distant": [{"direction": [0, 1, 0], "radiance": 1, "angular_diameter_degrees": 0}]},
            "$.distant[0].angular_diameter_degrees",
            "a lamp needs a size",
        ),
        ({"distant": [{"direction": [0, 0, 0], "sun": True}]}, "$.distant[0].direction", "no length"),
        ({"distant": [{"direction": [0, 1, 0]}]}, "$.distant[0]", "found none"),
        (
            {"distant": [{"direction": [0, 1, 0], "sun": True, "radiance": 1}]},
            "$.distant[0]",
            "radiance and sun",
        ),
        ({"environment": {"radiance": {"illuminant": "D65"}}}, "$.environment.radiance", "add its luminance"),
        ({"environment": {}}, "$.environment", '"asset", "radiance"'),
        (
            {"environment": {"asset": "sky.exr", "up": [0, 0, 1]}},
            "$.environment.forward",
            "forward is parallel to up",
        ),
    ],
)
def test_wrong_light_from_afar_is_told(
    document: dict[str, Any], blobs: BlobStore, changes: dict[str, Any], place: str, words: str
) -> None:
    expect_problem(document | changes, blobs, place, words)


def test_a_photometric_file_is_for_flat_shapes_and_spheres(
    document: dict[str, Any], blobs: BlobStore
) -> None:
    document["surfaces"][1]["luminaire"]["profile"] = {"asset": photometric(blobs)}
    document["surfaces"][1]["shape"] = _BOX
    expect_problem(document, blobs, "$.surfaces[1].luminaire.profile", "a flat shape or a sphere")


@pytest.mark.parametrize(
    ("hidden", "expected"),
    [
        (None, scene_pb2.HIDDEN_FROM_NOBODY),
        ("camera", scene_pb2.HIDDEN_FROM_CAMERA),
        ("camera_and_mirrors", scene_pb2.HIDDEN_FROM_CAMERA_AND_MIRRORS),
    ],
)
@pytest.mark.parametrize("environment", [{"radiance": 1.0}, {"cie": 5, "illuminance": 1.0}])
def test_lights_are_hidden_from_cameras_only(
    document: dict[str, Any],
    compiled: Compile,
    hidden: str | None,
    expected: int,
    environment: dict[str, Any],
) -> None:
    document["surfaces"][1]["luminaire"]["hidden_from"] = hidden
    document["environment"] = environment | {"hidden_from": hidden}
    document["distant"] = [{"direction": [0, 1, 0], "radiance": 1.0, "hidden_from": hidden}]

    def found() -> list[int]:
        scene = compiled(document)
        [luminaire], [disc] = scene.luminaires, scene.distant_discs
        return [luminaire.hidden_from, disc.hidden_from, scene.environment.hidden_from]

    assert found() == [expected] * 3
    document["sensor"] = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, 1], "height": 1}
    assert found() == [scene_pb2.HIDDEN_FROM_NOBODY] * 3


def test_a_light_is_hidden_from_somebody_known(document: dict[str, Any], blobs: BlobStore) -> None:
    document["surfaces"][1]["luminaire"]["hidden_from"] = "everybody"
    expect_problem(document, blobs, "$.surfaces[1].luminaire.hidden_from", "camera_and_mirrors")


@pytest.mark.parametrize("amount", [{}, {"lumens": 800}, {"watts": 9}, {"exitance": 50}])
def test_maintenance_and_dimming_scale_all_amounts(
    amount: dict[str, Any], document: dict[str, Any], compiled: Compile
) -> None:
    """0.8 of a lamp that is dimmed to a quarter is 0.2 of it, however its amount is given."""
    lamp = document["surfaces"][1]
    lamp["luminaire"] = {"radiance": {"blackbody": 3000}, **amount}

    def light() -> Any:
        scene = compiled(document)
        return evaluate(scene, scene.luminaires[0].radiance.spectrum)

    full = light()
    lamp["luminaire"] |= {"maintenance_factor": 0.8, "dimming": 0.25}
    assert light() == pytest.approx(0.2 * full, rel=1e-6)


def test_maintenance_scales_a_photometric_file(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    """Its candelas are those of a spectrum of 1 cd/m2."""
    lamp = document["surfaces"][1]["luminaire"]
    lamp["profile"] = {"asset": photometric(blobs), "lumens": 1000}
    lamp["maintenance_factor"] = 0.67
    scene = compiled(document)
    spectrum = scene.spectra[scene.luminaires[0].radiance.spectrum]
    assert spectra.luminance(spectrum) == pytest.approx(0.67, rel=1e-6)
