"""Lamps as the rays of a file: what meters get is what the rays bring, near the lamp and far from it."""

import math
from pathlib import Path

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_scene.photometry import far_field, tm25
from nocturne_scene.tile_sums import Values

from tests.accuracy.tracing import Document, part_of, run, run_seeds, trace, write
from tests.system.images import Image

pytestmark = pytest.mark.system

_RADIUS, _LUMENS = 0.05, 800.0
_LED = np.array([400.0, 455.0, 500.0, 560.0, 620.0, 700.0]), np.array([0.0, 1.0, 0.3, 0.7, 0.4, 0.05])
_EDGE = 8


def _disc(count: int) -> tm25.RayFile:
    """Of a disc that emits by the cosine, up along z; rays of unequal flux, RMS 1.10 of the mean."""
    chance = np.random.default_rng(11)
    sine, around = np.sqrt(chance.random(count)), 2 * np.pi * chance.random(count)
    directions = np.stack([sine * np.cos(around), sine * np.sin(around), np.sqrt(1 - sine**2)], axis=1)
    r, at = _RADIUS * np.sqrt(chance.random(count)), 2 * np.pi * chance.random(count)
    starts = np.stack([r * np.cos(at), r * np.sin(at), np.zeros(count)], axis=1)
    flux = chance.uniform(0.2, 1.8, count)
    flux *= _LUMENS / flux.sum()
    parts = starts.astype(np.float32), directions.astype(np.float32), None, flux.astype(np.float32)
    return tm25.RayFile(*parts, spectra=[_LED])


def _scene(distance: float, edge: float, **tracing: object) -> Document:
    """A film that faces the lamp; one black surface, as a scene needs one."""
    far = {"type": "sphere", "centre": [0, 0, -50], "radius": 0.1}
    return {
        "nocturne": 1,
        "sensor": {
            "type": "irradiance_meter",
            "position": [0, 0, distance],
            "normal": [0, 0, -1],
            "up": [0, 1, 0],
            "height": edge,
        },
        "surfaces": [{"shape": far, "kernel": {"type": "lambertian", "reflectance": 0}}],
        "tracing": {"sequence": "independent", **tracing},
    }


def _near(distance: float, edge: float, **lamp: object) -> Document:
    return _scene(distance, edge) | {"ray_files": [{"asset": "lamp.tm25ray", **lamp}]}


def _lux(rays: tm25.RayFile, compiled: CompiledFolder, distance: float, edge: float) -> Values:
    """What the rays bring to each pixel, by a second method: where each of them meets the film's plane."""
    sensor = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes()).sensor
    starts, directions = rays.starts.astype(np.float64), rays.directions.astype(np.float64)
    # A meter's film stands off its plane by 2^-18 of its extent (worker/src/sensors/plane.h): a micrometre,
    # which takes two of 3,000 rays to the next pixel, and 12 of its standard errors with 2^14 samples.
    height = distance - 2.0**-18 * (distance + edge)
    at = starts + directions * ((height - starts[:, 2]) / directions[:, 2])[:, None]
    right, up = (np.array([each.x, each.y]) for each in (sensor.right, sensor.up))
    column = np.floor((at[:, :2] @ right / edge + 0.5) * _EDGE).astype(int)
    row = np.floor((0.5 - at[:, :2] @ up / edge) * _EDGE).astype(int)
    inside = (column >= 0) & (column < _EDGE) & (row >= 0) & (row < _EDGE)
    assert rays.lumens is not None
    flux = np.bincount((row * _EDGE + column)[inside], rays.lumens[inside], _EDGE**2)
    return flux.reshape(_EDGE, _EDGE) / (edge / _EDGE) ** 2


@pytest.mark.parametrize(("distance", "edge"), [(0.03, 0.2), (0.5, 0.4)])
def test_a_film_gets_what_the_rays_bring(tmp_path: Path, distance: float, edge: float) -> None:
    """In every pixel, for few rays: photons leave along nothing else. Pixels are as many trials, and few have
    anything to do with each other; eight seeds know a scatter to a quarter."""
    rays = _disc(3000)
    tm25.write(tmp_path / "lamp.tm25ray", rays)
    compiled = compile_to(write(_near(distance, edge), tmp_path), tmp_path, _EDGE, _EDGE, part_of(1 << 14))
    truth = _lux(rays, compiled, distance, edge)
    images = [image for image, _ in run_seeds(compiled, tmp_path, 8)]
    z = np.array([(image.y - truth) / np.maximum(image.y_error, 1e-9) for image in images])
    lit = truth > 0
    assert lit.sum() > 50
    assert z[:, lit].std() == pytest.approx(1.0, abs=0.15)
    assert abs(z[:, lit].mean()) < 4 / math.sqrt(8 * lit.sum())
    assert np.all([image.y[~lit] == 0 for image in images])


def test_a_disc_near_and_far_is_as_on_paper(tmp_path: Path) -> None:
    """On the axis of an even disc that emits by the cosine E is its flux over pi (a^2 + d^2); of its far
    field, over pi d^2, twice as much at d = a. Rays that meet the film are as many draws."""
    rays = _disc(200_000)
    assert rays.lumens is not None
    tm25.write(tmp_path / "lamp.tm25ray", rays)
    for distance, edge in ((_RADIUS, 0.02), (20 * _RADIUS, 0.2)):
        compiled = compile_to(
            write(_near(distance, edge), tmp_path), tmp_path, _EDGE, _EDGE, part_of(1 << 16)
        )
        image, _ = run(compiled, tmp_path)
        met = _lux(rays, compiled, distance, edge).mean() * edge**2
        draws = met / rays.lumens.mean()
        error = math.hypot(1.10 / math.sqrt(draws), _relative_error(image))
        expected = _LUMENS / (math.pi * (_RADIUS**2 + distance**2))
        # Over the film it falls by half of (edge / distance)^2 at most.
        assert image.y.mean() == pytest.approx(expected, rel=4 * error + 0.01), distance


def _relative_error(image: Image) -> float:
    return float(np.sqrt(np.square(image.y_error).sum()) / image.y.sum())


def test_far_away_it_is_its_far_field(tmp_path: Path) -> None:
    """The same rays as a photometric file, 40 radii away."""
    rays = _disc(200_000)
    tm25.write(tmp_path / "lamp.tm25ray", rays)
    distance, edge = 40 * _RADIUS, 2.0
    near = trace(_near(distance, edge), tmp_path, _EDGE, part_of(1 << 15))
    candela, _ = far_field.candela_of(rays, 1, 90)
    angles = np.append(0.0, np.append((np.arange(90) + 0.5) * 2.0, 180.0))
    values = np.append(candela[0, 0], np.append(candela[:, 0], 0.0))
    profile = "\n".join(" ".join(f"{each:.6g}" for each in row) for row in (angles, [0.0], values))
    head = f"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {len(angles)} 1 1 2 0 0 0\n1 1 10\n"
    (tmp_path / "far.ies").write_text(f"{head}{profile}\n")
    document = _scene(distance, edge, direction="adjoint", sharing=1)
    ball = {"type": "sphere", "centre": [0, 0, 0], "radius": 0.02}
    light = {
        "radiance": {"table": [list(each) for each in zip(*(part.tolist() for part in _LED), strict=True)]},
        "profile": {"asset": "far.ies", "axis": [0, 0, 1], "zero": [1, 0, 0], "lumens": _LUMENS},
    }
    black = {"type": "lambertian", "reflectance": 0}
    document["surfaces"].append({"shape": ball, "kernel": black, "luminaire": light})
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "far.ies").write_text((tmp_path / "far.ies").read_text())
    far = trace(document, tmp_path / "far", _EDGE, part_of(1 << 10))
    met = near.y.mean() * edge**2 / _LUMENS * len(rays.starts)
    error = math.hypot(1.10 / math.sqrt(met), math.hypot(_relative_error(near), _relative_error(far)))
    # The ball's own size changes 1 / d^2 by 2 (0.02 / 2)^2, the disc's by (1 / 40)^2.
    assert near.y.mean() == pytest.approx(far.y.mean(), rel=4 * error + 0.001)
    assert near.xyz[..., 0].sum() / near.xyz[..., 1].sum() == pytest.approx(
        far.xyz[..., 0].sum() / far.xyz[..., 1].sum(), rel=0.02
    )


def test_flux_scales_and_turns(tmp_path: Path) -> None:
    """A lamp that is turned to look along x, shifted and dimmed, before a film that looks back."""
    rays = _disc(2000)
    tm25.write(tmp_path / "lamp.tm25ray", rays)
    stands = {"rotate": {"axis": [0, 1, 0], "degrees": 90}, "translate": [1, 2, 3]}
    document = _near(0.5, 0.4, lumens=300, dimming=0.5, **stands)
    document["sensor"] |= {"position": [1.5, 2, 3], "normal": [-1, 0, 0]}
    image = trace(document, tmp_path, _EDGE, part_of(1 << 14))
    (tmp_path / "plain").mkdir()
    compiled = compile_to(write(_near(0.5, 0.4), tmp_path), tmp_path / "plain", _EDGE, _EDGE, 1)
    truth = _lux(rays, compiled, 0.5, 0.4).mean() * 150.0 / _LUMENS
    assert image.y.mean() == pytest.approx(truth, rel=4 * _relative_error(image))
