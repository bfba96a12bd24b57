"""`nocturne doctor`: missing parts on this machine, and how to get them; with --url, whether a service can be
used from here, and can render."""

import importlib.util
import shutil
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from email.utils import parsedate_to_datetime
from pathlib import Path

from rich.markup import escape
from rich.table import Table

from nocturne_client.client import Client
from nocturne_client.contract import Worker
from nocturne_client.errors import NocturneClientError
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


_CLOCK_S = 5.0
"""Apart from which times of stop conditions and of the list mislead."""


def examine_service(url: str | None) -> list[Finding]:
    """Looks at one service; questions that can't be asked any more are left out."""
    with Client(url) as client:
        found: list[Finding] = []
        try:
            found.extend(_answers(client))
            found.extend(_workers([*client.workers()]))
        except NocturneClientError as error:
            advice = "check the address, the network and the token (NOCTURNE_TOKEN)"
            found.append(Finding(f"service at {client.url}", False, str(error), advice))
        return found


def _answers(client: Client) -> Iterator[Finding]:
    session, date = client.session()
    who = f"as {session.name}" if session.name else "without a token, as nobody needs one"
    yield Finding(f"service at {client.url}", True, f"answers {who}")
    may = "submit" in session.scopes
    yield Finding("may submit", may, ", ".join(session.scopes), "ask for a token with `submit`", needed=False)
    ready = client.is_ready()
    advice = "its log says why: the database, or no coordinator"
    yield Finding("ready", ready, "yes" if ready else "no", advice)
    if date:
        apart = abs(parsedate_to_datetime(date).timestamp() - time.time())
        advice = "set both clocks (NTP): times of --until are those of the service"
        yield Finding("clocks", apart < _CLOCK_S, f"{apart:.0f} s apart", advice, needed=False)


def _workers(workers: list[Worker]) -> Iterator[Finding]:
    able = [each for each in workers if not each.quarantine and not each.incompatible]
    found = f"{len(able)} with {sum(each.threads for each in able)} threads"
    kept = next((each.quarantine or each.incompatible for each in workers if each not in able), "")
    told = f"{found}; {len(workers) - len(able)} get no jobs: {kept}" if kept else found
    yield Finding("workers", bool(able), told, "start `nocturne-worker`, or `nocturne workers --release`")
