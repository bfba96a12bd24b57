"""Writes the reference of the scene document from its schema, so that the two cannot differ.

python -m nocturne_scene.document.reference > docs/reference/scene.md
python -m nocturne_scene.document.reference --schema > docs/reference/scene.schema.json
"""

import inspect
import json
import sys
from typing import Any

from nocturne_scene import limits
from nocturne_scene.document.read import SceneDocument, parse_document

SCHEMA_ID = "https://json-schema.org/draft/2020-12/schema"

# The order of the page: from the whole to its parts.
_ORDER = (
    "SceneDocument",
    "Surface",
    "Instance",
    "PlacementsFile",
    "Rotation",
    "RigidMotion",
    "Turn",
    "KeyedMotion",
    "Placement",
    "InlineMesh",
    "AssetMesh",
    "Quad",
    "Sphere",
    "Disc",
    "Box",
    "MediumBox",
    "Interior",
    "Medium",
    "Droplets",
    "ExponentialDensity",
    "LayeredDensity",
    "AbovePlane",
    "AboveSphere",
    "Grid",
    "IsotropicPhase",
    "HenyeyGreensteinPhase",
    "DoubleHenyeyGreensteinPhase",
    "RayleighPhase",
    "TabulatedPhase",
    "ScatteringMatrix",
    "MiePhase",
    "Dye",
    "Atmosphere",
    "AtmosphericAir",
    "AtmosphericOzone",
    "AtmosphericAerosol",
    "Lambertian",
    "Fluorophore",
    "Reradiation",
    "DiffuseTransmitter",
    "Conductor",
    "Dielectric",
    "ThinPane",
    "Glazing",
    "SheetPane",
    "FilmPane",
    "MeasuredPane",
    "FilmLayer",
    "CoatedDiffuse",
    "Phong",
    "Principled",
    "Measured",
    "Polariser",
    "Retarder",
    "Blend",
    "Mask",
    "TwoSided",
    "NullKernel",
    "SellmeierIndex",
    "SellmeierCoefficients",
    "CauchyIndex",
    "TableIndex",
    "ComplexIndex",
    "TableExtinction",
    "Texture",
    "ColourTexture",
    "ScalarTexture",
    "NormalMap",
    "BumpMap",
    "Luminaire",
    "CosineProfile",
    "PhotometricProfile",
    "ConstantEnvironment",
    "EnvironmentMap",
    "StandardSky",
    "WeatherSky",
    "Place",
    "DistantDisc",
    "RayFile",
    "ImportantDirection",
    "Wavelengths",
    "ConstantSpectrum",
    "TableSpectrum",
    "BlackbodySpectrum",
    "IlluminantSpectrum",
    "SolarSpectrum",
    "LineSpectrum",
    "SpectralLine",
    "RgbSpectrum",
    "ChartSpectrum",
    "Pinhole",
    "ThinLens",
    "Aperture",
    "Bands",
    "Orthographic",
    "Panorama",
    "IrradianceMeter",
    "RadianceMeter",
    "IntensityMeter",
    "Meters",
    "Instrument",
    "MeterGrid",
    "Tracing",
    "Mixture",
)

EXAMPLE = """\
{
  "nocturne": 1,
  "name": "A lamp above a table",
  "spectra": {
    "oak": {"table": [[400, 0.12], [500, 0.22], [600, 0.38], [700, 0.47]]},
    "lamp": {"blackbody": 2900, "luminance": 5000}
  },
  "kernels": {"oak": {"type": "lambertian", "reflectance": "oak"}},
  "sensor": {
    "type": "pinhole",
    "position": [0, 1.5, -3],
    "look_at": [0, 0.7, 0],
    "vertical_field_of_view_degrees": 35
  },
  "surfaces": [
    {
      "name": "table top",
      "shape": {"type": "quad", "corner": [-1, 0.7, -0.5], "edge_u": [0, 0, 1], "edge_v": [2, 0, 0]},
      "kernel": "oak"
    },
    {
      "name": "lamp",
      "shape": {"type": "sphere", "centre": [0, 1.4, 0], "radius": 0.08},
      "kernel": {"type": "lambertian", "reflectance": 0.1},
      "luminaire": {"radiance": "lamp"}
    }
  ]
}
"""

_INTRODUCTION = f"""\
# The scene document

<!-- Made by `python -m nocturne_scene.document.reference`; edit the descriptions in the schema, not this
page. -->

A scene is one JSON document (UTF-8, at most {limits.MAX_SCENE_BYTES // 2**20} MiB, at most
{limits.MAX_SCENE_NESTING} levels deep). Lengths are metres, angles degrees, wavelengths nanometres,
radiance W m⁻² sr⁻¹ nm⁻¹; the image is in absolute units, its Y in cd/m². The number of pixels and of samples
is not part of a scene.

Fields that this page does not name are errors, as are repeated keys, NaN and numbers out of range. An error
names its place, such as `$.surfaces[3].kernel.reflectance`, and the expected value. The same schema as
JSON Schema: [scene.schema.json](scene.schema.json).

Only used parts of a document are compiled: spectra, kernels and media that nothing refers to, triangles
without an area, surfaces that all light passes, luminaires without visible light and motions that move
nothing are left out, and the compiler says so. How to put media into a scene, with an example:
[media.md](../how-to/media.md).

```json
{EXAMPLE}```
"""

_WORDS = {"number": "number", "integer": "whole number", "boolean": "`true` or `false`"}


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of the scene document."""
    return {"$schema": SCHEMA_ID, **SceneDocument.model_json_schema()}


def page() -> str:
    """Return the reference as Markdown."""
    parse_document(EXAMPLE)
    schema = json_schema()
    objects = {"SceneDocument": schema, **schema["$defs"]}
    missing = set(objects) - set(_ORDER)
    if missing:
        raise ValueError(f"add to the order of the page: {sorted(missing)}")
    return "\n".join([_INTRODUCTION, *(_section(name, objects[name]) for name in _ORDER)])


def _section(name: str, schema: dict[str, Any]) -> str:
    required = schema.get("required", [])
    fields = sorted(
        schema["properties"].items(), key=lambda item: item[0] != "type"
    )  # "type" first, else as is
    rows = [_row(field, of, field in required) for field, of in fields]
    return "\n".join(
        [
            f"## {name}",
            "",
            inspect.cleandoc(schema["description"]),
            "",
            "| field | value | default | meaning |",
            "| --- | --- | --- | --- |",
            *rows,
            "",
        ]
    )


def _row(name: str, schema: dict[str, Any], required: bool) -> str:
    default = "required" if required else _default(schema.get("default"))
    return f"| `{name}` | {_value(schema)} | {default} | {schema.get('description', '')} |"


def _default(value: Any) -> str:
    if value is None or value == "" or isinstance(value, dict):
        return ""
    return f"`{json.dumps(value)}`"


def _value(schema: dict[str, Any]) -> str:
    """Say in words what a JSON Schema allows."""
    arms = schema.get("oneOf") or schema.get("anyOf")
    if arms:
        return " or ".join(_value(arm) for arm in arms if arm.get("type") != "null")
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return " or ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    match schema["type"]:
        case "array":
            return _list(schema)
        case "object":
            [entry] = schema["patternProperties"].values()
            return f"object of {_value(entry)} by name"
        case "string":
            return "name" if schema.get("title") == "name" else "text"
        case other:
            return _WORDS[other]


def _list(schema: dict[str, Any]) -> str:
    if "prefixItems" in schema:
        return f"[{', '.join(_value(item) for item in schema['prefixItems'])}]"
    return f"list of {_value(schema['items'])}"


def main(arguments: list[str]) -> int:
    """Write the page, or with --schema the JSON Schema, to standard output."""
    if arguments not in ([], ["--schema"]):
        sys.stderr.write("usage: python -m nocturne_scene.document.reference [--schema]\n")
        return 2
    text = json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n" if arguments else page()
    sys.stdout.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
