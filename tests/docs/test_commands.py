"""What pages tell to type is understood: every command by the real parser, every option by its command."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer
from nocturne_client.cli.app import app
from nocturne_client.cli.help_panels import PANELS

ROOT = Path(__file__).parents[2]
PROGRAM: Any = typer.main.get_command(app)

PAGES = sorted(
    [
        *(page for page in ROOT.glob("docs/**/*.md") if page.name != "commands.md"),
        *ROOT.glob("examples/*/README.md"),
        *(ROOT / name for name in ("README.md", "bench/README.md", "services/web/README.md")),
    ]
)

_FENCE = re.compile(r"^```(?:sh|console|bash)?[^\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
_INDENTED = re.compile(r"(?:^ {4}\S[^\n]*\n?)+", re.MULTILINE)
_INLINE = re.compile(r"`(nocturne [^`]+)`")
_CALL = re.compile(r"(?:^|\$\(|[|;&]\s*|\bdo\s+|\buntil\s+)(nocturne [^\n|;&)>]*)", re.MULTILINE)


def _typed(text: str) -> Iterator[str]:
    """Commands in blocks of code, each on one line."""
    blocks = [*_FENCE.findall(text), *_INDENTED.findall(_FENCE.sub("", text))]
    for block in blocks:
        lines = re.sub(r"\\\n\s*", " ", re.sub(r"^ {4}|^\$ ", "", block, flags=re.MULTILINE))
        yield from (found.strip() for found in _CALL.findall(lines))


def _inline(text: str) -> list[str]:
    """Commands in the middle of text, with brackets and dots where something is left to the reader."""
    found = [*_INLINE.findall(_FENCE.sub("", text)), *(each for each in _typed(text) if _is_form(each))]
    return [re.sub(r"\s+", " ", each) for each in found]


def _is_form(text: str) -> bool:
    """Whether the text shows a command's form, and is not to be typed as it is."""
    return "[" in text


def problem_of(words: list[str]) -> str:
    """Why the program would not take these words; empty where it would. Runs nothing."""
    command: Any = PROGRAM
    name, context = "nocturne", None
    try:
        while True:
            context = command.make_context(name, list(words), parent=context)
            if not hasattr(command, "resolve_command"):
                return ""
            name, command, words = command.resolve_command(context, context._protected_args + context.args)
    except Exception as problem:
        # The parser's own errors, whose module is typer's private one.
        if not hasattr(problem, "format_message"):
            raise
        return str(problem.format_message()) or type(problem).__name__


TYPED = [
    (page, each) for page in PAGES for each in _typed(page.read_text(encoding="utf-8")) if not _is_form(each)
]


def test_commands_are_found() -> None:
    assert len(TYPED) > 50
    assert {"nocturne up", "nocturne list"} <= {each for _, each in TYPED}


@pytest.mark.parametrize(("page", "text"), TYPED, ids=[text for _, text in TYPED])
def test_a_command_of_a_page_is_understood(page: Path, text: str) -> None:
    words = shlex.split(text, comments=True)[1:]
    if {"--help", "--version"} & set(words):
        return
    assert problem_of(words) == "", page.relative_to(ROOT)


def test_options_in_text_are_those_of_their_commands() -> None:
    unknown = []
    for page in PAGES:
        for text in _inline(page.read_text(encoding="utf-8")):
            # Only this one: after a comma another may follow.
            words = re.split(r"[ ,]", text)[1:]
            command: Any = PROGRAM
            while words and (sub := getattr(command, "commands", {}).get(words[0])):
                command, words = sub, words[1:]
            known = {
                name for parameter in command.params for name in (*parameter.opts, *parameter.secondary_opts)
            }
            known |= {"--help", "--version", "--install-completion", "--show-completion"}
            named = {each.strip("[]") for each in words if each.strip("[]").startswith("-")}
            unknown += [f"{page.relative_to(ROOT)}: {text}: {each}" for each in sorted(named - known)]
    assert unknown == []


@pytest.mark.parametrize(
    "text",
    [
        *("render scene.json", "render scene.json -o a.exr --patience 3", "sing", "get"),
        *("submit a.json --width x", "webhook forget", "export scene.json --to paint -o there"),
    ],
)
def test_what_is_no_command_would_be_found_out(text: str) -> None:
    assert problem_of(shlex.split(text)) != ""


def test_the_page_has_every_command_with_an_example() -> None:
    page = (ROOT / "docs" / "reference" / "command-line.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"`nocturne ([a-z]+)\b[^`]*` \|$", page, re.MULTILINE))
    named = {
        name
        for row in re.findall(r"^\| ((?:`[a-z]+`(?:, )?)+)", page, re.MULTILINE)
        for name in row.split("`")[1::2]
    }
    assert set(PROGRAM.commands) <= named
    # Of pairs one is shown.
    assert set(PROGRAM.commands) - shown == {"resume", "join"}


def test_the_help_has_every_command_in_a_panel_with_a_short_line() -> None:
    lines = {name: line for panel in PANELS.values() for name, line in panel.items()}
    assert set(lines) == set(PROGRAM.commands)
    assert [line for line in lines.values() if len(line) > 60 or line.endswith(".")] == []
