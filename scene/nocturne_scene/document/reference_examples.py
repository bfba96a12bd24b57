"""An example of each type of the scene document, as its reference shows it.

Long: a table of examples, which is read by name.

A head has the type and where the example stands: `kernel` is that of a ball, `sheet` that of an upright quad,
and so on (`examples/reference_pictures.py` has the scenes, renders the pictures, and makes the files that
are named here). `whole` is part of the top level of a document.
"""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Example:
    """One example."""

    at: str
    text: str


_TEXT = """
# Wavelengths whole
{"wavelengths": {"first": 280, "last": 1100}}
# Surface whole
{"surfaces": [
  {
    "name": "tilted plate",
    "shape": {"type": "box", "minimum": [-0.4, 0, -0.3], "maximum": [0.4, 0.1, 0.3]},
    "kernel": {"type": "lambertian", "reflectance": 0.6},
    "rotate": {"axis": [0, 0, 1], "degrees": 30},
    "translate": [0, 0.4, 0]
  }
]}
# Instance whole
{
  "groups": {"ball": [
    {
      "shape": {"type": "sphere", "centre": [0, 0.15, 0], "radius": 0.15},
      "kernel": {"type": "coated_diffuse", "index": 1.5, "reflectance": {"rgb": [0.1, 0.3, 0.6]}}
    }
  ]},
  "instances": [
    {"group": "ball", "placements": {"asset": "places.ply"}},
    {"group": "ball", "scale": 2, "translate": [0, 0, -0.4]}
  ]
}
# Rotation surface
{
  "shape": {"type": "box", "minimum": [-0.3, 0, -0.3], "maximum": [0.3, 0.4, 0.3]},
  "kernel": {"type": "lambertian", "reflectance": 0.7},
  "scale": 1.2,
  "rotate": {"axis": [0, 1, 0], "degrees": 30},
  "translate": [0, 0.2, 0]
}
# RigidMotion surface
{
  "shape": {"type": "box", "minimum": [-0.5, 0.4, -0.1], "maximum": [0.5, 0.5, 0.1]},
  "kernel": {"type": "lambertian", "reflectance": 0.7},
  "motion": {"rotate": {"axis": [0, 0, 1], "degrees": 40, "about": [-0.5, 0.45, 0]}}
}
# KeyedMotion surface
{
  "shape": {"type": "sphere", "centre": [0, 0.3, 0], "radius": 0.3},
  "kernel": {"type": "lambertian", "reflectance": 0.7},
  "motion": {
    "placements": [{"translate": [-0.3, 0, 0]}, {"translate": [0, 0.4, 0]}, {"translate": [0.3, 0, 0]}]
  }
}
# InlineMesh shape
{
  "type": "mesh",
  "vertices": [[-0.5, 0, 0.3], [0.5, 0, 0.3], [0, 0, -0.6], [0, 0.9, 0]],
  "triangles": [[0, 1, 3], [1, 2, 3], [2, 0, 3]]
}
# AssetMesh shape
{"type": "mesh", "asset": "knot.ply", "smooth": true}
# Quad shape
{"type": "quad", "corner": [-0.5, 0.1, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0.8, -0.3]}
# Sphere shape
{"type": "sphere", "centre": [0, 0.5, 0], "radius": 0.5}
# Disc shape
{"type": "disc", "centre": [0, 0.5, 0], "normal": [0, 0.5, 1], "radius": 0.5}
# Box shape
{"type": "box", "minimum": [-0.4, 0, -0.4], "maximum": [0.4, 0.8, 0.4]}
# MediumBox whole
{
  "media": {
    "smoke": {"absorption": 1, "scattering": 8, "density": {"asset": "smoke.vdb", "grid": "density"}}
  },
  "surfaces": [{"shape": {"type": "medium_box", "medium": "smoke"}, "interior": {"media": ["smoke"]}}]
}
# Lambertian kernel
{"type": "lambertian", "reflectance": {"rgb": [0.7, 0.25, 0.1]}}
# Fluorophore kernel
{
  "type": "lambertian",
  "reflectance": 0.1,
  "fluorescence": [
    {
      "absorption": {"table": [[360, 0.8], [480, 0.8], [520, 0]]},
      "emission": {"table": [[500, 0], [530, 1], [600, 0]]},
      "quantum_yield": 0.9
    }
  ]
}
# Reradiation kernel
{
  "type": "lambertian",
  "reflectance": 0.1,
  "fluorescence": [
    {
      "excitation_nm": [380, 440, 500],
      "emission_nm": [560, 600, 640],
      "values": [[0, 0.004, 0], [0, 0.008, 0], [0, 0.002, 0]]
    }
  ]
}
# DiffuseTransmitter sheet
{"type": "diffuse_transmitter", "reflectance": 0.3, "transmittance": {"rgb": [0.3, 0.5, 0.1]}}
# Conductor kernel
{"type": "conductor", "index": "Au", "roughness": 0.15}
# Dielectric kernel
{"type": "dielectric", "index": "N-BK7"}
# ThinPane sheet
{"type": "thin_pane", "index": 1.52, "transmittance": {"rgb": [0.6, 0.9, 0.7]}}
# CoatedDiffuse kernel
{"type": "coated_diffuse", "index": 1.5, "roughness": 0.02, "reflectance": {"rgb": [0.05, 0.2, 0.5]}}
# Phong kernel
{"type": "phong", "reflectance": 0.7, "exponent": 60}
# Principled kernel
{
  "type": "principled",
  "base": {"rgb": [0.6, 0.05, 0.05]},
  "metallic": 0.6,
  "roughness": 0.4,
  "coat": 1
}
# Measured kernel
{"type": "measured", "asset": "paint.table", "format": "table"}
# Blend kernel
{
  "type": "blend",
  "first": {"type": "lambertian", "reflectance": {"rgb": [0.1, 0.4, 0.1]}},
  "second": {"type": "conductor", "index": "Cu"},
  "weight": 0.4
}
# Mask sheet
{"type": "mask", "kernel": {"type": "lambertian", "reflectance": 0.8}, "opacity": 0.5}
# TwoSided sheet
{
  "type": "two_sided",
  "front": {"type": "lambertian", "reflectance": {"rgb": [0.7, 0.1, 0.1]}},
  "back": {"type": "lambertian", "reflectance": {"rgb": [0.1, 0.1, 0.7]}}
}
# NullKernel surface
{
  "shape": {"type": "sphere", "centre": [0, 0.5, 0], "radius": 0.3},
  "kernel": {"type": "null"},
  "luminaire": {"radiance": {"blackbody": 2700, "luminance": 400}}
}
# FilmLayer kernel
{
  "type": "conductor",
  "index": "Al",
  "coating": [{"index": "MgF2", "thickness_nm": 500}]
}
# Glazing sheet
{"type": "glazing", "panes": [
  {"index": 1.52, "back": [{"index": "Ag", "thickness_nm": 12}]},
  {"film": [{"index": 1.33, "thickness_nm": 400}]}
]}
# MeasuredPane sheet
{"type": "glazing", "panes": [
  {"front_reflectance": 0.08, "back_reflectance": 0.08, "transmittance": 0.84},
  {"front_reflectance": 0.12, "back_reflectance": 0.1, "transmittance": {"rgb": [0.5, 0.6, 0.5]}}
]}
# Polariser sheet
{"type": "polariser", "axis": [1, 0, 0], "transmittance": 0.8}
# Retarder sheet
{"type": "retarder", "axis": [1, 1, 0], "retardance_nm": 137.5}
# ConstantSpectrum spectrum
{"constant": 0.5}
# TableSpectrum spectrum
{"table": [[400, 0.05], [500, 0.1], [560, 0.5], [600, 0.7], [700, 0.75]]}
# RgbSpectrum spectrum
{"rgb": [0.1, 0.3, 0.6]}
# ChartSpectrum spectrum
{"chart_patch": "bluish green"}
# BlackbodySpectrum radiance
{"blackbody": 2700, "luminance": 400}
# IlluminantSpectrum radiance
{"illuminant": "FL2", "luminance": 400}
# SolarSpectrum radiance
{"solar": "direct", "luminance": 400}
# LineSpectrum radiance
{"lines": [{"nm": 589.0, "power": 2}, {"nm": 589.6, "power": 1}], "luminance": 400}
# SellmeierIndex kernel
{
  "type": "dielectric",
  "index": {"sellmeier": {"b": [1.0396, 0.2318, 1.0105], "c": [0.0060007, 0.020018, 103.56]}}
}
# CauchyIndex kernel
{"type": "dielectric", "index": {"cauchy": [1.5046, 0.0042]}}
# TableIndex kernel
{"type": "dielectric", "index": {"table": [[400, 1.531], [550, 1.519], [700, 1.513]]}}
# ComplexIndex kernel
{
  "type": "conductor",
  "index": {
    "n": {"table": [[400, 1.5], [550, 0.4], [700, 0.15]]},
    "k": {"table": [[400, 1.9], [550, 2.4], [700, 4.0]]}
  }
}
# ColourTexture surface
{
  "shape": {"type": "sphere", "centre": [0, 0.5, 0], "radius": 0.5},
  "rotate": {"axis": [1, 0, 0], "degrees": -90},
  "translate": [0, 0.5, 0.5],
  "kernel": {
    "type": "lambertian",
    "reflectance": {"texture": {"asset": "checks.png", "sharp": true}, "scale": [2, 1]}
  }
}
# ScalarTexture surface
{
  "shape": {"type": "quad", "corner": [-0.5, 0.05, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0.9, 0]},
  "kernel": {
    "type": "mask",
    "kernel": {"type": "lambertian", "reflectance": 0.8},
    "opacity": {"texture": {"asset": "checks.png"}, "gain": 0.8, "bias": 0.1}
  }
}
# NormalMap surface
{
  "shape": {"type": "quad", "corner": [-0.5, 0.05, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0.9, 0]},
  "kernel": {"type": "conductor", "index": "Cu", "roughness": 0.3},
  "normal_map": {"texture": {"asset": "normals.png"}}
}
# BumpMap surface
{
  "shape": {"type": "quad", "corner": [-0.5, 0.05, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0.9, 0]},
  "kernel": {"type": "coated_diffuse", "index": 1.5, "roughness": 0.1, "reflectance": 0.4},
  "bump_map": {"texture": {"asset": "bumps.png"}, "scale": [2, 2], "height": 0.03}
}
# Medium whole
{
  "media": {"milk": {"preset": "whole milk"}},
  "surfaces": [
    {
      "shape": {"type": "sphere", "centre": [0, 0.5, 0], "radius": 0.5},
      "scale": 0.02,
      "kernel": {"type": "dielectric", "index": 1.33},
      "interior": {"media": ["milk"]}
    }
  ]
}
# Droplets medium
{"droplets": {"mode_radius": 4e-6, "alpha": 6, "number": 1e10}}
# ExponentialDensity medium
{
  "scattering": 12,
  "density": {"scale_height": 0.25, "at_ground": 1, "above": {"point": [0, 0, 0], "up": [0, 1, 0]}}
}
# LayeredDensity medium
{
  "scattering": 12,
  "density": {
    "layers": [[0, 0], [0.3, 1], [0.6, 0]],
    "above": {"centre": [0, -100, 0], "radius": 100}
  }
}
# Dye medium
{
  "scattering": 6,
  "fluorescence": [{
    "absorption": {"table": [[400, 3], [450, 20], [500, 0]]},
    "emission": {"table": [[490, 0], [530, 1], [600, 0]]},
    "quantum_yield": 0.9
  }]
}
# Grid whole
{
  "media": {
    "fire": {
      "absorption": 4,
      "density": {"asset": "smoke.vdb", "grid": "density"},
      "temperature": {"asset": "smoke.vdb", "grid": "temperature"}
    }
  },
  "surfaces": [{"shape": {"type": "medium_box", "medium": "fire"}, "interior": {"media": ["fire"]}}]
}
# IsotropicPhase phase
{"type": "isotropic"}
# HenyeyGreensteinPhase phase
{"type": "henyey_greenstein", "g": 0.7}
# DoubleHenyeyGreensteinPhase phase
{"type": "double_henyey_greenstein", "first": 0.8, "second": -0.3, "weight": 0.9}
# RayleighPhase phase
{"type": "rayleigh", "depolarisation": 0.028}
# TabulatedPhase phase
{"type": "tabulated", "cosines": [-1, 0, 0.8, 1], "values": [[0.3, 0.1, 0.5, 2]]}
# ScatteringMatrix phase
{
  "type": "tabulated",
  "cosines": [-1, 0, 1],
  "values": [[1.5, 0.75, 1.5]],
  "matrix": {"s12": [[0, -1, 0]], "s33": [[-1, 0, 1]], "s34": [[0, 0, 0]]}
}
# MiePhase phase
{"type": "mie", "droplets": {"mode_radius": 4e-6, "alpha": 6}}
# Luminaire surface
{
  "shape": {"type": "quad", "corner": [-0.3, 1.2, -0.3], "edge_u": [0.6, 0, 0], "edge_v": [0, 0, 0.6]},
  "kernel": {"type": "lambertian", "reflectance": 0.1},
  "luminaire": {"radiance": {"illuminant": "FL11"}, "lumens": 2000}
}
# CosineProfile surface
{
  "shape": {"type": "quad", "corner": [-0.3, 1.2, -0.3], "edge_u": [0.6, 0, 0], "edge_v": [0, 0, 0.6]},
  "kernel": {"type": "lambertian", "reflectance": 0.1},
  "luminaire": {"radiance": {"blackbody": 3000}, "lumens": 500, "profile": {"cosine_power": 20}}
}
# PhotometricProfile surface
{
  "shape": {"type": "quad", "corner": [-0.1, 1.2, -0.4], "edge_u": [0.2, 0, 0], "edge_v": [0, 0, 0.2]},
  "kernel": {"type": "lambertian", "reflectance": 0.1},
  "luminaire": {"radiance": {"blackbody": 3000}, "profile": {"asset": "spot.ies"}}
}
# RayFile whole
{
  "ray_files": [
    {"asset": "led.tm25ray", "rotate": {"axis": [1, 0, 0], "degrees": 90}, "translate": [0, 1, 0]}
  ],
  "sensor": {"type": "irradiance_meter", "position": [0, 0.1, 0], "normal": [0, 1, 0], "height": 1}
}
# ConstantEnvironment environment
{"radiance": {"illuminant": "D65", "luminance": 1000}}
# EnvironmentMap environment
{"asset": "sky.exr", "luminance": 2000, "rotate_degrees": 90}
# StandardSky environment
{
  "cie": 12,
  "place": {"latitude": 48.8, "longitude": 9.2},
  "time": "2026-06-21T16:00+02:00",
  "illuminance": 15000,
  "sun_illuminance": 80000
}
# WeatherSky environment
{"sun": [0.5, 0.6, 0.6], "diffuse_horizontal": 120, "direct_normal": 600}
# DistantDisc whole
{"distant": [{"direction": [0.4, 0.8, 0.5], "sun": true, "limb_darkening": true}]}
# Atmosphere whole
{
  "media": {"haze": {"preset": "continental haze"}},
  "atmosphere": {
    "air": {"pressure": 101325},
    "ozone": {"dobson_units": 300},
    "aerosol": {"medium": "haze", "optical_depth": 0.1}
  },
  "distant": [{"direction": [-0.5, 0.25, -0.8], "sun": true}]
}
# Pinhole sensor
{
  "type": "pinhole",
  "position": [0, 0.9, 2.6],
  "look_at": [0, 0.45, 0],
  "vertical_field_of_view_degrees": 30
}
# ThinLens sensor
{
  "type": "thin_lens",
  "position": [0, 0.9, 2.6],
  "look_at": [0, 0.45, 0],
  "vertical_field_of_view_degrees": 30,
  "lens_radius": 0.1,
  "focus_distance": 2.1,
  "aperture": {"blades": 6}
}
# Orthographic sensor
{"type": "orthographic", "position": [2, 2, 2], "look_at": [0, 0.4, 0], "height": 1.6}
# Panorama sensor
{"type": "panorama", "position": [0, 0.8, 1.2], "look_at": [0, 0.8, 0]}
# IrradianceMeter sensor
{"type": "irradiance_meter", "position": [0, 0.02, 0], "normal": [0, 1, 0], "height": 2.4}
# RadianceMeter sensor
{
  "type": "radiance_meter",
  "position": [0, 0.9, 2.6],
  "look_at": [0, 0.5, 0],
  "diameter": 0.01,
  "cone_degrees": 1
}
# IntensityMeter whole
{
  "sensor": {"type": "intensity_meter", "position": [0, 1.6, 0], "lamp_radius": 1},
  "surfaces": [
    {
      "shape": {"type": "disc", "centre": [0, 1.6, 0], "normal": [0, -1, 0], "radius": 0.1},
      "kernel": {"type": "lambertian", "reflectance": 0.1},
      "luminaire": {"radiance": {"blackbody": 3000}, "lumens": 800}
    }
  ]
}
# Meters sensor
{
  "type": "meters",
  "instruments": [
    {"name": "floor", "grid": {"corner": [-1, 0.02, 1], "right": [2, 0, 0], "up": [0, 0, -2], "border": 0.2}},
    {"name": "eye", "points": [[0, 1.2, 1]], "normal": [0, 0, -1]},
    {"name": "wall", "faces": {"surface": "wall", "count": 16, "spread": true}}
  ]
}
# YearOfDaylight sensor
{
  "type": "meters",
  "instruments": [
    {"name": "floor", "grid": {"corner": [-1, 0.02, 1], "right": [2, 0, 0], "up": [0, 0, -2], "border": 0.2}}
  ],
  "daylight": {"of": "sky", "weather": {"asset": "year.epw"}}
}
# Bands sensor
{
  "type": "pinhole",
  "position": [0, 0.9, 2.6],
  "look_at": [0, 0.45, 0],
  "vertical_field_of_view_degrees": 30,
  "bands": {"first": 380, "last": 780, "width": 20}
}
# Tracing tracing
{"direction": "adjoint", "maximum_depth": 20, "seed": 7, "mixture": {"kernel": 0.5, "luminaires": 0.5}}
# ImportantDirection whole
{"important_directions": [
  {"shape": {"type": "disc", "centre": [0, 1.2, 0], "normal": [0, -1, 0], "radius": 0.3}, "weight": 2}
]}
"""


def examples() -> dict[str, Example]:
    """By the type's name."""
    parts = re.split(r"^# (\w+) (\w+)\n", _TEXT.strip() + "\n", flags=re.MULTILINE)[1:]
    return {
        name: Example(at, text.strip())
        for name, at, text in zip(parts[0::3], parts[1::3], parts[2::3], strict=True)
    }
