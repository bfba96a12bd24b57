"""Writes the Python client's models from docs/reference/openapi.json, so that the two cannot differ.

python services/client/generate_models.py > services/client/nocturne_client/contract.py
"""

import json
import sys
import textwrap
from pathlib import Path
from typing import Any

_SOURCE = Path(__file__).parents[2] / "docs" / "reference" / "openapi.json"
# What the client gives to its callers, with all that these consist of.
_WANTED = (
    "Render",
    "Explanation",
    "Reading",
    "Measurements",
    "Isolines",
    "Glare",
    "Group",
    "Session",
    "MeasuredRegions",
    "Worker",
    "WorkOfWorker",
    "Usage",
    "Webhook",
    "NewWebhook",
    "PreflightReport",
    "ImportedScene",
)
# Documents, which callers know as dictionaries.
_PLAIN = ("SceneDocument",)
_WIDTH = 110
_HEAD = '''"""The service's answers as values. Made from docs/reference/openapi.json by generate_models.py."""

from dataclasses import dataclass
from typing import Any, Literal'''
_TYPES = {"string": "str", "integer": "int", "number": "float", "boolean": "bool", "object": "dict[str, Any]"}


def module(description: dict[str, Any]) -> str:
    """The source of the module of models."""
    schemas = description["components"]["schemas"]
    parts = [_HEAD]
    for name in _with_parts(schemas):
        schema = schemas[name]
        parts.append(_enumeration(name, schema) if "enum" in schema else _class(name, schema))
    return "\n\n".join(parts).replace("\n\n\n\n", "\n\n\n")


def _with_parts(schemas: dict[str, Any]) -> list[str]:
    """Names of the wanted models, each after those that it consists of."""
    found: list[str] = []

    def visit(name: str) -> None:
        for used in _references(schemas[name]):
            visit(used)
        if name not in found and name not in _PLAIN:
            found.append(name)

    for name in _WANTED:
        visit(name)
    return found


def _references(schema: Any) -> list[str]:
    if isinstance(schema, list):
        return [name for each in schema for name in _references(each)]
    if not isinstance(schema, dict):
        return []
    own = [_name(schema["$ref"])] if "$ref" in schema else []
    return own + [name for key, value in schema.items() if key != "examples" for name in _references(value)]


def _name(reference: str) -> str:
    return reference.removeprefix("#/components/schemas/")


def _enumeration(name: str, schema: dict[str, Any]) -> str:
    values = "".join(f'    "{value}",\n' for value in schema["enum"])
    return f"{name} = Literal[\n{values}]\n{_documented(schema['description'], '')}\n"


def _class(name: str, schema: dict[str, Any]) -> str:
    lines = ["@dataclass(frozen=True)", f"class {name}:", _documented(schema["description"], "    "), ""]
    for field, about in schema["properties"].items():
        if field not in schema["required"]:
            raise ValueError(f"{name}.{field}: an answer may leave it out, which no model here can say")
        lines.append(f"    {field}: {_type(about)}")
        if "description" in about:
            lines.append(_documented(about["description"], "    "))
    return "\n".join(lines) + "\n"


def _documented(text: str, indent: str) -> str:
    """A docstring of lines that are not too long."""
    first, *rest = text.split("\n\n")
    lines = textwrap.wrap(first, _WIDTH - len(indent) - 6)
    for paragraph in rest:
        lines += ["", *textwrap.wrap(paragraph, _WIDTH - len(indent) - 6)]
    if len(lines) == 1:
        return f'{indent}"""{lines[0]}"""'
    body = "\n".join(f"{indent}{line}".rstrip() for line in lines[1:])
    return f'{indent}"""{lines[0]}\n{body}\n{indent}"""'


def _type(schema: dict[str, Any]) -> str:
    if "$ref" in schema:
        name = _name(schema["$ref"])
        return _TYPES["object"] if name in _PLAIN else name
    if "anyOf" in schema:
        return " | ".join(_type(each) for each in schema["anyOf"])
    if schema["type"] == "null":
        return "None"
    if schema["type"] == "array":
        return f"list[{_type(schema['items'])}]"
    return _TYPES[schema["type"]]


def main() -> None:
    """Prints the module."""
    sys.stdout.write(module(json.loads(_SOURCE.read_text(encoding="utf-8"))))


if __name__ == "__main__":
    main()
