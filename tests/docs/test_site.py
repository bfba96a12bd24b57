"""The documentation site: it builds without a warning, and every link within it leads somewhere.

Tests that need the site are run by `make docs`; links between the pages' sources are in test_docs.py, in
every run.
"""

import os
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from tests.docs.test_docs import ROOT


class _Page(HTMLParser):
    """What a page links to, and the names that others may link to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: set[str] = set()
        self.names: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if value and name == "id":
                self.names.add(value)
            elif value and (tag, name) in {
                ("a", "href"),
                ("img", "src"),
                ("link", "href"),
                ("script", "src"),
            }:
                self.links.add(value)


def _dead(site: Path) -> list[str]:
    """Links within the site that lead nowhere."""
    pages = {page: _Page(page.read_text(encoding="utf-8")) for page in site.rglob("*.html")}
    dead = []
    for page, content in pages.items():
        for link in content.links:
            address = urlsplit(link)
            if address.scheme or address.netloc:
                continue
            found = (page.parent / unquote(address.path)).resolve() if address.path else page
            name = unquote(address.fragment)
            if not found.exists() or (name and found in pages and name not in pages[found].names):
                dead.append(f"{page.relative_to(site)}: {link}")
    return sorted(dead)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site: the one of `make docs`, or a fresh one."""
    if "NOCTURNE_SITE" in os.environ:
        return Path(os.environ["NOCTURNE_SITE"]).resolve()
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--quiet"]
    places: list[str | Path] = ["-c", ROOT / "docs", "-d", folder / "doctrees", ROOT, folder / "html"]
    built = subprocess.run([*command, *places], capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    return (folder / "html").resolve()


@pytest.mark.soak
def test_links_within_the_site_lead_somewhere(site: Path) -> None:
    assert _dead(site) == []


@pytest.mark.soak
def test_the_site_has_all_its_parts(site: Path) -> None:
    for page in ("index", "docs/quick-start", "docs/gallery", "docs/reference/python", "examples/fog/README"):
        assert (site / f"{page}.html").is_file(), page
    python = (site / "docs" / "reference" / "python.html").read_text(encoding="utf-8")
    assert "nocturne_client.Client.submit" in python


def test_a_dead_link_is_found(tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text('<p id="here"></p><a href="#here"></a><a href="b.html#there"></a>')
    (tmp_path / "b.html").write_text(
        '<a href="a.html#here"></a><a href="c.html"></a><a href="https://x.y"></a>'
    )
    assert _dead(tmp_path) == ["a.html: b.html#there", "b.html: c.html"]
