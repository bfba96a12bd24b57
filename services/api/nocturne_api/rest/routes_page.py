"""docs/reference/routes.md: all routes as tables. `python -m nocturne_api.rest.routes_page` prints it."""

import sys
from typing import Any

from nocturne_api.rest.app import described_app

_HEAD = """# All routes

Made from the service's own description, `docs/reference/openapi.json`, by `make contract`. The service shows
it with schemas and examples at `/docs`, and gives it at `/openapi.json`. What the operations mean, and their
gRPC methods, is in [the API](api.md).
"""
_EVERYWHERE = ("401", "403", "422", "429", "500", "503")
_OF_ANY_BODY = {"TOO_SLOW"}
_OF_ONE_RENDER = {"NOT_FOUND", "AMBIGUOUS_ID"}


def page(description: dict[str, Any]) -> str:
    """One table for each tag, in the order of the description."""
    parts = [_HEAD]
    for tag in description["tags"]:
        rows = [
            _row(method, path, operation)
            for path, methods in description["paths"].items()
            for method, operation in methods.items()
            if tag["name"] in operation["tags"]
        ]
        title = f"## {tag['name'].capitalize()}\n\n{tag['description']}\n"
        head = "| route | what | body | answer | errors |\n| --- | --- | --- | --- | --- |"
        parts.append("\n".join([title, head, *rows]) + "\n")
    codes = ", ".join(_EVERYWHERE)
    parts.append(
        f"In addition, every route under `/v1` may answer {codes} and TOO_SLOW, and routes of one render "
        "NOT_FOUND and AMBIGUOUS_ID: see [errors](api.md#errors).\n"
    )
    return "\n".join(parts)


def _row(method: str, path: str, operation: dict[str, Any]) -> str:
    body = ", ".join(_content(operation.get("requestBody", {})))
    answers = operation["responses"]
    good = [f"{status} {', '.join(_content(answers[status]))}".strip() for status in answers if status < "4"]
    errors = [status for status in answers if status >= "4" and status not in _EVERYWHERE]
    named = [each for status in errors for each in answers[status]["$ref"].rpartition("/")[2].split("-")]
    usual = _OF_ANY_BODY | (_OF_ONE_RENDER if "{render_id}" in path else set())
    told = ", ".join(each for each in named if each not in usual)
    cells = (f"`{method.upper()} {path}`", operation["summary"], body, "; ".join(good), told)
    return f"| {' | '.join(cells)} |"


def _content(part: dict[str, Any]) -> list[str]:
    """The schemas by name, or the media types."""
    return [
        f"`{content['schema']['$ref'].rpartition('/')[2]}`"
        if "$ref" in content.get("schema", {})
        else media_type
        for media_type, content in part.get("content", {}).items()
    ]


def main() -> None:
    """Prints the page."""
    sys.stdout.write(page(described_app().openapi()))


if __name__ == "__main__":
    main()
