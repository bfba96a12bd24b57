"""docs/reference/daemons.md has every option of the three daemons and every alert, and no other option."""

import re
import subprocess
from pathlib import Path

import pytest
from nocturne_client.local.programs import need_program

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "reference" / "daemons.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("program", ["nocturne-coordinator", "nocturne-api", "nocturne-worker"])
def test_the_page_has_every_option(program: str) -> None:
    shown = subprocess.run([need_program(program), "--help"], capture_output=True, text=True, check=True)
    known = set(re.findall(r"^ {2}(?:-\w, ?)?(--[a-z-]+)\b", shown.stdout, re.MULTILINE)) - {"--help"}
    section = PAGE.partition(f"## {program}\n")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| (`--.+?) \|", section, re.MULTILINE)
    told = {option for row in rows for option in re.findall(r"`(--[a-z-]+)`", row)}
    assert told == known


def test_the_page_has_every_alert() -> None:
    rules = (ROOT / "deploy" / "prometheus" / "alerts.yml").read_text(encoding="utf-8")
    table = PAGE.partition("| alert |")[2]
    assert [name for name in re.findall(r"alert: (\w+)", rules) if name not in table] == []
