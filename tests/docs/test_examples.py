"""Every example has a page with a picture, and the gallery shows all of them with their costs."""

import json
import re

import pytest

from examples.gallery import EXAMPLES, FIGURES, MAX_PICTURE_BYTES, PAGE, Picture, page, pictures

FOLDERS = sorted(readme.parent.name for readme in EXAMPLES.glob("*/README.md"))
PICTURES = pictures()


def test_every_folder_is_an_example_in_the_gallery() -> None:
    folders = {path.name for path in EXAMPLES.iterdir() if path.is_dir() and not path.name.startswith("__")}
    assert folders == set(FOLDERS) == {picture.folder for picture in PICTURES}


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_page_shows_its_pictures_and_how_its_files_are_made(folder: str) -> None:
    text = (EXAMPLES / folder / "README.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text))
    assert shown == {each.file.partition("/")[2] for each in PICTURES if each.folder == folder}
    for program in (EXAMPLES / folder).glob("make_*.py"):
        assert f"python examples/{folder}/{program.name}" in text


@pytest.mark.parametrize("picture", PICTURES, ids=lambda picture: picture.scene)
def test_pictures_are_there_and_small(picture: Picture) -> None:
    file = EXAMPLES / picture.file
    assert file.read_bytes()[8:12] == b"WEBP"
    assert file.stat().st_size <= MAX_PICTURE_BYTES[picture.is_large]


def test_the_gallery_is_made_of_what_is_kept() -> None:
    """Make it again with `python -m examples.gallery --page`."""
    assert set(json.loads(FIGURES.read_text())["pictures"]) == {picture.scene for picture in PICTURES}
    assert PAGE.read_text(encoding="utf-8") == page()
