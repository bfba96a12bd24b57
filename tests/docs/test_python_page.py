"""Calls of the Python client that pages show fit its methods."""

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from nocturne_client import Client

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "docs" / "reference" / "python.md", ROOT / "docs" / "quick-start.md"]


def _calls(text: str) -> Iterator[ast.Call]:
    """Of `client.something(...)`, in blocks and between backquotes."""
    pieces = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    pieces += re.findall(r"`(client\.[^`]+\))`", text)
    for piece in pieces:
        for node in ast.walk(ast.parse(piece)):
            if isinstance(node, ast.Call) and ast.unparse(node.func).startswith("client."):
                yield node


CALLS = [call for page in PAGES for call in _calls(page.read_text(encoding="utf-8"))]


def test_calls_are_found() -> None:
    assert len(CALLS) > 20


@pytest.mark.parametrize("call", CALLS, ids=ast.unparse)
def test_a_call_fits_its_method(call: ast.Call) -> None:
    method = getattr(Client, ast.unparse(call.func).removeprefix("client."))
    named = {keyword.arg: None for keyword in call.keywords if keyword.arg}
    inspect.signature(method).bind(None, *call.args, **named)


def test_a_call_that_does_not_fit_is_found() -> None:
    (call,) = _calls("`client.submit(scene, wide=3)`")
    with pytest.raises(TypeError):
        test_a_call_fits_its_method(call)
