"""Files and functions are divided by ideas. What stays long says so, and why, in its first lines."""

import ast
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDERS = ("bench", "coordinator", "docs", "examples", "proto", "scene", "services", "tests", "worker")
ENDINGS = {".py", ".h", ".cpp", ".proto", ".ts", ".mjs", ".css"}
NOT_OURS = {"node_modules", "dist", "__pycache__", "build"}
MADE = {"services/client/nocturne_client/contract.py", "services/web/src/service/openapi.d.ts"}
"""By `make contract`, and by the page's build."""

MAX_LINES, FIRST_LINES = 350, 20
MAX_FUNCTION = 60
MAX_BYTES = 1_500_000
"""Of a file that is kept; the table of colours has 1.2 million. Data of other programs stay outside."""
OPTIONS = {
    ("services/api/nocturne_api/main.py", "_settings"),
    ("services/client/nocturne_client/cli/annual_command.py", "annual"),
    ("services/client/nocturne_client/cli/measure_commands.py", "measure"),
    ("services/client/nocturne_client/cli/report_command.py", "report"),
    ("services/client/nocturne_client/cli/up_commands.py", "up"),
    ("services/client/nocturne_client/cli/submit_command.py", "submit"),
}
"""Functions that are lists of options."""


_LONG = re.compile(r"\blong\b", re.IGNORECASE)


def files() -> Iterator[Path]:
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*"):
            inside = path.relative_to(ROOT)
            if path.suffix in ENDINGS and not NOT_OURS & set(inside.parts) and str(inside) not in MADE:
                yield path


def test_long_files_say_why() -> None:
    lines = {path: path.read_text(encoding="utf-8").splitlines() for path in files()}
    long = [path for path, each in lines.items() if len(each) > MAX_LINES]
    assert len(lines) > 500
    assert long
    silent = [path for path in long if not _LONG.search("\n".join(lines[path][:FIRST_LINES]))]
    assert [str(path.relative_to(ROOT)) for path in silent] == []


def test_long_functions_are_lists_of_options() -> None:
    found = {
        (str(path.relative_to(ROOT)), node.name)
        for path in files()
        if path.suffix == ".py"
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (node.end_lineno or 0) - node.lineno >= MAX_FUNCTION
    }
    assert found == OPTIONS


def test_no_large_file_is_kept() -> None:
    """A peer's 200 megabytes of tables were, once, by a command that wrote them where it was started."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True)
    kept = [ROOT / name for name in listed.stdout.split("\0") if name]
    large = [path.name for path in kept if path.is_file() and path.stat().st_size > MAX_BYTES]
    assert not large
