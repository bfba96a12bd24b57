"""Reads an image file of a stranger and writes it as tiles: FILE TILES EDGE. What is wrong goes to stdout."""

import resource
import sys
from pathlib import Path

from nocturne_scene.compare.images import read_picture
from nocturne_scene.errors import InputError

from nocturne_api.files.tiles import encode_picture
from nocturne_api.limits import PICTURE_MEMORY_BYTES, PICTURE_PIXELS

UNREADABLE = 3
"""Exit code where the file is at fault."""


def main() -> None:
    """Does it within bounds of memory."""
    file, tiles, edge = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
    resource.setrlimit(resource.RLIMIT_AS, (PICTURE_MEMORY_BYTES, PICTURE_MEMORY_BYTES))
    try:
        picture = read_picture(file, PICTURE_PIXELS)
    except InputError as error:
        sys.stdout.write(error.problems[0].message)
        sys.exit(UNREADABLE)
    tiles.write_bytes(encode_picture(picture, edge))


if __name__ == "__main__":
    main()
