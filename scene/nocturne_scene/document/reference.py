"""Writes the reference of the scene document from its schema, so that the two cannot differ.

python -m nocturne_scene.document.reference docs/reference

Into the folder: scene.md, the pages in scene/, scene.schema.json.
"""

import inspect
import json
import sys
from pathlib import Path
from typing import Any

from nocturne_scene import limits
from nocturne_scene.document.read import SceneDocument, parse_document
from nocturne_scene.document.reference_examples import examples
from nocturne_scene.document.reference_pages import (
    INDEX,
    SHARED,
    SHOWN_WITH,
    SUBJECTS,
    UNIONS,
    SharedFields,
    Subject,
    Union,
)

SCHEMA_ID = "https://json-schema.org/draft/2020-12/schema"

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
radiance W m⁻² sr⁻¹ nm⁻¹. The image is in absolute units, its Y in cd/m². The number of pixels and of samples
is not part of a scene.

```json
{EXAMPLE}```

Fields that these pages do not name are errors, as are repeated keys, NaN and numbers out of range. An error
names its place, such as `$.surfaces[3].kernel.reflectance`, and the expected value. Editors can check a
document by its JSON Schema: [scene.schema.json](scene.schema.json).

A document with `base` is an [overlay](../how-to/overlays.md): the command line makes a scene of it and of the
document that it lies over.

Only used parts of a document are compiled. The compiler names the parts that it leaves out: spectra, kernels
and media that nothing refers to, triangles without an area, surfaces that all light passes, luminaires
without visible light, and motions that move nothing.
"""

_TABLE = ("| field | value | default | meaning |", "| --- | --- | --- | --- |")
_WORDS = {"number": "number", "integer": "whole number", "boolean": "`true` or `false`"}
_PICTURES = "../images/scene"


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of the scene document."""
    return {"$schema": SCHEMA_ID, **SceneDocument.model_json_schema()}


class _Reference:
    """The pages, of one schema. Links within are as from the index page, until a page is finished."""

    def __init__(self, pictures: frozenset[str]) -> None:
        schema = json_schema()
        self._pictures = pictures
        self._objects: dict[str, dict[str, Any]] = {"SceneDocument": schema, **schema["$defs"]}
        self._files = dict.fromkeys(INDEX, "scene.md")
        self._files |= {name: f"scene/{each.file}.md" for each in SUBJECTS for name in each.types}
        self._examples = examples()
        missing = set(self._objects) ^ set(self._files)
        if missing:
            raise ValueError(f"add to, or take from, reference_pages.py: {sorted(missing)}")
        missing = set(self._objects) ^ (set(self._examples) | set(SHOWN_WITH))
        if missing:
            raise ValueError(f"an example is missing, or one too many: {sorted(missing)}")

    def index(self) -> str:
        rows = [
            f"| [{each.title}](scene/{each.file}.md) | {', '.join(map(self._link, each.types))} |"
            for each in SUBJECTS
        ]
        subjects = ["## Pages by subject", "", "| page | types |", "| --- | --- |", *rows, ""]
        files = "\n".join(f"scene/{each.file}" for each in SUBJECTS)
        pages = f"```{{toctree}}\n:hidden:\n\n{files}\n```\n"
        parts = [_INTRODUCTION, "\n".join(subjects), *map(self._section, INDEX), pages]
        return "\n".join(parts).replace("](scene.md#", "](#")

    def page(self, subject: Subject) -> str:
        head = f"# {subject.title}\n\n{subject.about} Other pages: [the scene document](scene.md).\n"
        unions = [self._union(each) for each in UNIONS if each.file == subject.file]
        shared = [self._shared(each) for each in SHARED if each.file == subject.file]
        text = "\n".join([head, *unions, *map(self._section, subject.types), *shared])
        # From the folder below the index page.
        text = text.replace("](../", "](../../").replace("](scene.md", "](../scene.md")
        return text.replace(f"](scene/{subject.file}.md#", "](#").replace("](scene/", "](")

    def _link(self, name: str) -> str:
        return f"[{name}]({self._files[name]}#{name.lower()})"

    def _section(self, name: str) -> str:
        schema = self._objects[name]
        rows = self._rows(name)
        shared = [each for each in SHARED if self._has(name, each)]
        known = {field for each in shared for field in each.fields}
        if name in self._examples:
            # Its example has the one value.
            known.add("type")
        own = [rows[field] for field in rows if field not in known]
        parts = [f"## {name}", "", inspect.cleandoc(schema["description"]), ""]
        parts += self._example(name)
        if own:
            parts += [*_TABLE, *own, ""]
        if shared:
            parts += [f"Also the {' and the '.join(map(_shared_link, shared))}.", ""]
        return "\n".join(parts)

    def _example(self, name: str) -> list[str]:
        if (other := SHOWN_WITH.get(name)) is not None:
            return [f"Example: that of {self._link(other)}.", ""] if other else []
        shown = ["```json", self._examples[name].text, "```", ""]
        if name in self._pictures:
            shown = [f"![Example of {name}]({_PICTURES}/{name.lower()}.webp)", "", *shown]
        return shown

    def _rows(self, name: str) -> dict[str, str]:
        """By field; `type` first, else as in the schema."""
        schema = self._objects[name]
        required = schema.get("required", [])
        fields = sorted(schema["properties"].items(), key=lambda item: item[0] != "type")
        return {field: self._row(field, of, field in required) for field, of in fields}

    def _has(self, name: str, shared: SharedFields) -> bool:
        """Whether a type has these fields, all of them as the first type that does."""
        rows = self._rows(name)
        first = self._rows(self._first(shared))
        return all(field in rows and rows[field] == first[field] for field in shared.fields)

    def _first(self, shared: SharedFields) -> str:
        order = [name for each in SUBJECTS for name in each.types]
        having = [each for each in order if set(shared.fields) <= set(self._objects[each]["properties"])]
        return having[0]

    def _shared(self, shared: SharedFields) -> str:
        rows = self._rows(self._first(shared))
        having = [name for each in SUBJECTS for name in each.types if self._has(name, shared)]
        of = f"Of {', '.join(map(self._link, having))}."
        table = [*_TABLE, *(rows[each] for each in shared.fields)]
        return "\n".join([f"## {shared.name}", "", of, "", *table, ""])

    def _union(self, union: Union) -> str:
        return f"## {union.name}\n\n{union.about} {', '.join(map(self._link, union.types))}.\n"

    def _row(self, name: str, schema: dict[str, Any], required: bool) -> str:
        default = "required" if required else _default(schema.get("default"))
        return f"| `{name}` | {self._value(schema)} | {default} | {schema.get('description', '')} |"

    def _value(self, schema: dict[str, Any]) -> str:
        """Say in words what a JSON Schema allows."""
        arms = schema.get("oneOf") or schema.get("anyOf")
        if arms:
            return " or ".join(self._arms([arm for arm in arms if arm.get("type") != "null"]))
        if "$ref" in schema:
            return self._link(_type_of(schema))
        if "const" in schema:
            return f"`{json.dumps(schema['const'])}`"
        if "enum" in schema:
            return " or ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
        match schema["type"]:
            case "array":
                return self._list(schema)
            case "object":
                [entry] = schema["patternProperties"].values()
                return f"object of {self._value(entry)} by name"
            case "string":
                return "name" if schema.get("title") == "name" else "text"
            case other:
                return _WORDS[other]

    def _arms(self, arms: list[dict[str, Any]]) -> list[str]:
        """The alternatives of one place, with one word for all types of a union."""
        flat = [one for arm in arms for one in (arm.get("oneOf") or arm.get("anyOf") or [arm])]
        types = {_type_of(arm) for arm in flat if "$ref" in arm}
        words: list[str] = []
        for union in UNIONS:
            if set(union.types) <= types:
                words.append(f"[{union.name}](scene/{union.file}.md#{union.name.lower().replace(' ', '-')})")
                flat = [arm for arm in flat if "$ref" not in arm or _type_of(arm) not in union.types]
                if union.with_name_or_number and any(arm.get("title") == "name" for arm in flat):
                    flat = [arm for arm in flat if arm.get("type") not in {"string", "number"}]
        return [*words, *(self._value(arm) for arm in flat)]

    def _list(self, schema: dict[str, Any]) -> str:
        if "prefixItems" in schema:
            return f"[{', '.join(self._value(item) for item in schema['prefixItems'])}]"
        return f"list of {self._value(schema['items'])}"


def _type_of(schema: dict[str, Any]) -> str:
    return str(schema["$ref"].rpartition("/")[2])


def _shared_link(shared: SharedFields) -> str:
    name = shared.name[0].lower() + shared.name[1:]
    return f"[{name}](scene/{shared.file}.md#{shared.name.lower().replace(' ', '-')})"


def _default(value: Any) -> str:
    if value is None or value == "" or isinstance(value, dict):
        return ""
    return f"`{json.dumps(value)}`"


def pages(folder: Path) -> dict[Path, str]:
    """The reference, by file below `folder`, with the pictures that are there."""
    parse_document(EXAMPLE)
    pictures = {path.stem for path in (folder / _PICTURES).glob("*.webp")}
    reference = _Reference(frozenset(name for name in examples() if name.lower() in pictures))
    found = {folder / "scene.md": reference.index()}
    found |= {folder / "scene" / f"{each.file}.md": reference.page(each) for each in SUBJECTS}
    schema = json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n"
    return {**found, folder / "scene.schema.json": schema}


def main(arguments: list[str]) -> int:
    """Write the reference into the folder that is named."""
    if len(arguments) != 1 or arguments[0].startswith("-"):
        sys.stderr.write("usage: python -m nocturne_scene.document.reference FOLDER\n")
        return 2
    for path, text in pages(Path(arguments[0])).items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
