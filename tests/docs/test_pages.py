"""Pages that people wrote for users are short, and link to few decisions."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MOST_WORDS, MOST_DECISIONS = 1500, 2

DEVELOPERS = {
    *("docs/architecture.md", "docs/how-to/add-a-kernel.md", "docs/how-to/tests.md"),
    *("docs/explanation/promises.md", "docs/reference/dependencies.md"),
}
GENERATED = {
    "docs/reference/commands.md",
    "docs/reference/routes.md",
    "docs/reference/means-against-mitsuba.md",
}
"""And those that say so in a comment, and the scene reference."""


def pages() -> list[Path]:
    """Those written by hand for users."""
    found = [ROOT / "README.md"]
    for page in sorted((ROOT / "docs").rglob("*.md")):
        path = page.relative_to(ROOT).as_posix()
        apart = path in DEVELOPERS | GENERATED or path.startswith(
            ("docs/decisions/", "docs/reference/scene/")
        )
        if not apart and "<!-- Made by" not in page.read_text(encoding="utf-8"):
            found.append(page)
    return found


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.relative_to(ROOT).as_posix())
def test_a_page_is_short_and_links_to_few_decisions(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert len(_words(text)) <= MOST_WORDS
    assert len(set(re.findall(r"\]\([^)]*decisions/(\d{4})", text))) <= MOST_DECISIONS


def test_all_pages_for_users_are_as_long_as_a_short_book() -> None:
    """45,000 words that people wrote; tables count, code and addresses do not."""
    assert sum(len(_words(page.read_text(encoding="utf-8"))) for page in pages()) <= 45_000


def _words(text: str) -> list[str]:
    """Without blocks of code, code between backticks, and the addresses of links."""
    prose = re.sub(r"^```.*?^```|^    .*?$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"`[^`]*`|\]\([^)]*\)|<[^>]*>|[|]|-{3,}", " ", prose).split()
