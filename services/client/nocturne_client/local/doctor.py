"""`nocturne doctor`: missing parts on this machine, and how to get them."""

import importlib.util
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from rich.markup import escape
from rich.table import Table

from nocturne_client.local.data import default_data_folder
from nocturne_client.local.programs import HOW_TO_GET, find_program

_CPU_FLAGS = ("avx2", "bmi1", "bmi2", "fma", "f16c", "movbe")
_FREE_BYTES = 2 * 1024**3
_PACKAGES = (
    *("nocturne", "nocturne_coordinator", "nocturne_api", "colour", "trimesh", "OpenImageIO", "redis"),
    *("fastapi", "uvicorn", "grpc", "numpy", "prometheus_client", "scipy"),
)


@dataclass(frozen=True)
class Finding:
    """One thing looked for; `needed` ones are necessary to render."""

    name: str
    ok: bool
    found: str
    advice: str = ""
    needed: bool = True


def examine() -> list[Finding]:
    """Looks at everything."""
    return [
        *(_program(name) for name in HOW_TO_GET),
        *_packages(),
        _processor(),
        _disk(default_data_folder()),
        _page(),
        _chromium(),
    ]


def table_of(findings: list[Finding]) -> Table:
    """The findings for people."""
    table = Table("", "what", "found", "what to do", box=None, pad_edge=False)
    for finding in findings:
        mark = (
            "[green]ok[/]" if finding.ok else "[red]missing[/]" if finding.needed else "[yellow]optional[/]"
        )
        table.add_row(mark, finding.name, escape(finding.found), "" if finding.ok else escape(finding.advice))
    return table


def _program(name: str) -> Finding:
    path = find_program(name)
    if path is None:
        return Finding(name, False, "not found", HOW_TO_GET[name])
    try:
        asked = [path, "--version" if name == "redis-server" else "--help"]
        answer = subprocess.run(asked, capture_output=True, timeout=20, check=False)  # noqa: S603
    except (OSError, subprocess.TimeoutExpired) as error:
        return Finding(name, False, f"{path}: {error}", HOW_TO_GET[name])
    return Finding(name, answer.returncode == 0, str(path), f"it does not run here; {HOW_TO_GET[name]}")


def _packages() -> list[Finding]:
    missing = [name for name in _PACKAGES if importlib.util.find_spec(name) is None]
    if not missing:
        return [Finding("Python packages", True, "all there")]
    return [Finding("Python packages", False, f"missing: {', '.join(missing)}", "run `make venv`")]


def _processor() -> Finding:
    flags: set[str] = set()
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("flags"):
            flags = set(line.partition(":")[2].split())
            break
    lacking = [flag for flag in _CPU_FLAGS if flag not in flags]
    if not lacking:
        return Finding("processor", True, "x86-64-v3 (AVX2)")
    return Finding(
        "processor", False, f"lacks {', '.join(lacking)}", "use a machine with AVX2: any x86 since about 2015"
    )


def _disk(folder: Path) -> Finding:
    existing = next(each for each in (folder, *folder.parents) if each.exists())
    free = shutil.disk_usage(existing).free
    advice = "free some space, or choose another folder with `nocturne up --data`"
    return Finding("disk", free >= _FREE_BYTES, f"{free / 1024**3:.1f} GiB free at {existing}", advice)


def _page() -> Finding:
    # Not above: the API may be the missing part.
    from nocturne_api.rest.page import built_page

    index = built_page() / "index.html"
    found = str(index.parent) if index.is_file() else "not built"
    return Finding("web page", index.is_file(), found, "run `make web`", needed=False)


def _chromium() -> Finding:
    path = shutil.which("chromium")
    advice = "for the tests of the page: `sudo apt-get install chromium`"
    return Finding("chromium", path is not None, path or "not found", advice, needed=False)
