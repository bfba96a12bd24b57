"""Writes a stranger's image file as tiles: a job on standard input, problems on standard output, in JSON."""

import json
import resource
import sys
from pathlib import Path

from nocturne_scene.compare.images import read_picture
from nocturne_scene.errors import InputError

from nocturne_api.files.tiles import encode_picture
from nocturne_api.limits import PICTURE_MEMORY_BYTES, PICTURE_PIXELS


def main() -> None:
    """Does it within bounds of memory."""
    job = json.load(sys.stdin)
    resource.setrlimit(resource.RLIMIT_AS, (PICTURE_MEMORY_BYTES, PICTURE_MEMORY_BYTES))
    answer = {}
    try:
        picture = read_picture(Path(job["file"]), PICTURE_PIXELS)
    except InputError as error:
        answer = {"problems": [["$", error.problems[0].message]]}
    else:
        Path(job["tiles"]).write_bytes(encode_picture(picture, job["edge"]))
    json.dump(answer, sys.stdout)


if __name__ == "__main__":
    main()
