"""Environment maps."""

import io
import json
import math

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.blobs import NoteKey
from nocturne_scene.compile import spectra
from nocturne_scene.compile.sensors import unit, vector
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.daylight import perez
from nocturne_scene.document.luminaires import EnvironmentMap
from nocturne_scene.document.skies import StandardSky, WeatherSky
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.spectra import solar, sun
from nocturne_scene.spectra.published import Floats, visible_wavelengths
from nocturne_scene.textures import environment_maps, pictures, standard_skies

_SKY_ROWS, _SKY_COLUMNS = 1024, 256
"""Texels of a standard sky. Rows are equal steps of the zenith angle's cosine, so the first one is long: 3.6
degrees here. With 7.2 degrees (256 rows) a roof light read 0.3 % too much; columns are 1.4 degrees wide."""

_EVEN = 5
"""The CIE sky of uniform luminance."""

_CONVERSION = 2
"""Number of how pictures become texels; raised with every change of that, since texels are kept."""


def compile_sky(workspace: Workspace, sky: StandardSky | WeatherSky) -> scene_pb2.EnvironmentMap:
    """Return a sky by formulas as a map, with z up and the Sun at azimuth 0."""
    z = unit(np.array(sky.up))
    towards = sky.towards_sun()
    sun = unit(np.array(towards)) if towards is not None else z
    luminances = _luminances(sky, float(sun @ z))
    # Of one colour, so of one shape: that of white, times a scale.
    scale, coefficients = rgb_spectra.emission(np.ones(3))
    texels = np.empty((_SKY_ROWS, _SKY_COLUMNS, 4))
    texels[..., 0], texels[..., 1:] = luminances * float(scale), coefficients
    ahead = sun - (sun @ z) * z
    if np.linalg.norm(ahead) < 1e-9:
        ahead = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x = unit(ahead)
    _, d65 = rgb_spectra.d65_of_luminance(1.0)
    return scene_pb2.EnvironmentMap(
        blob=workspace.keep(texels.astype("<f4").tobytes()),
        columns=_SKY_COLUMNS,
        rows=_SKY_ROWS,
        spectrum=workspace.spectra.index_of(spectra.at_grid(d65)),
        x=vector(x),
        y=vector(np.cross(z, x)),
        z=vector(z),
    )


def _luminances(sky: StandardSky | WeatherSky, cos_sun: float) -> Floats:
    """Of the map's texels, cd/m2."""
    if isinstance(sky, StandardSky):
        found = standard_skies.texels(sky.cie, cos_sun, _SKY_ROWS, _SKY_COLUMNS)
        if sky.zenith_luminance is not None:
            return found * sky.zenith_luminance
        wanted = sky.illuminance or 0.0
    else:
        perez_sky = sky_of_weather(sky)
        found = standard_skies.mean_texels(
            lambda cos_zenith, cos_from_sun: perez.relative_luminance(
                perez_sky.parameters[0], cos_zenith, cos_from_sun
            ),
            cos_sun,
            _SKY_ROWS,
            _SKY_COLUMNS,
        )
        wanted = float(perez_sky.diffuse_illuminance[0])
        if not np.any(found > 0.0):
            found = standard_skies.texels(_EVEN, cos_sun, _SKY_ROWS, _SKY_COLUMNS)
    return found * (wanted / standard_skies.illuminance(found))


def sky_of_weather(sky: WeatherSky) -> perez.Sky:
    """Its illuminances and parameters, one of each."""
    return perez.sky_of(
        perez.Weather(
            direct_normal=np.array([sky.direct_normal]),
            diffuse_horizontal=np.array([sky.diffuse_horizontal]),
            sun_zenith=np.array([sky.sun_zenith()]),
            distance=np.array([sky.sun_distance()]),
            dew_point=np.array([sky.dew_point]),
        )
    )


def sun_of_sky(workspace: Workspace, sky: StandardSky | WeatherSky) -> scene_pb2.DistantDisc | None:
    """Return the Sun's disc that a sky comes with; None: it has none."""
    if isinstance(sky, StandardSky):
        wanted = sky.sun_illuminance
    else:
        wanted = 0.0 if sky.without_sun else float(sky_of_weather(sky).direct_illuminance[0])
    towards = sky.towards_sun()
    if not wanted > 0.0 or towards is None:
        return None
    within = workspace.spectral
    shape = np.interp(within.grid(), *solar.table("direct"), left=0.0, right=0.0)
    lumens = float(np.interp(visible_wavelengths(), *solar.table("direct")) @ spectra.response()[:, 1])
    distance = sky.sun_distance()
    half_angle = math.asin(math.sin(sun.half_angle()) / distance)
    radiance = shape * wanted / (lumens * math.pi * math.sin(half_angle) ** 2)
    return scene_pb2.DistantDisc(
        direction=vector(unit(np.array(towards))),
        half_angle=half_angle,
        radiance=workspace.spectra.index_of(spectra.at_grid(radiance, within)),
    )


def compile_map(workspace: Workspace, environment: EnvironmentMap) -> scene_pb2.EnvironmentMap:
    """Return the map with its frame: z up, x in the image's middle, y to the left of it. Raises Unusable."""
    asset = workspace.asset(environment.asset, ".asset").hex()
    blob, columns, rows = _texels(workspace, asset, points=environment.pixels == "points")
    _, d65 = rgb_spectra.d65_of_luminance(environment.luminance)
    z = unit(np.array(environment.up))
    ahead = np.array(environment.forward)
    ahead = unit(ahead - (ahead @ z) * z)
    left = np.cross(z, ahead)
    turn = math.radians(environment.rotate_degrees)
    return scene_pb2.EnvironmentMap(
        blob=blob,
        columns=columns,
        rows=rows,
        spectrum=workspace.spectra.index_of(spectra.at_grid(d65)),
        x=vector(math.cos(turn) * ahead + math.sin(turn) * left),
        y=vector(math.cos(turn) * left - math.sin(turn) * ahead),
        z=vector(z),
    )


def _texels(workspace: Workspace, asset: str, *, points: bool) -> tuple[bytes, int, int]:
    """Return digest, columns and rows of the map of a picture, made once for all scenes of a blob store."""
    text = json.dumps(["sky", points, _CONVERSION, rgb_spectra.table_digest()])
    about = NoteKey(asset, text)
    match workspace.made_before(about):
        case (bytes(blob), [int(columns), int(rows)]):
            return blob, columns, rows
    texels = io.BytesIO()
    try:
        columns, rows = environment_maps.convert(workspace.blobs.path(asset), texels, points=points)
    except pictures.UnusableImageError as error:
        raise Unusable(str(error), ".asset") from None
    blob = workspace.keep(texels.getvalue())
    workspace.note_made(about, blob, [columns, rows])
    return blob, columns, rows


def has_sky(scene: scene_pb2.CompiledScene) -> bool:
    """Whether a compiled scene has an environment, or discs at infinity such as the Sun's."""
    return scene.HasField("environment") or bool(scene.distant_discs)
