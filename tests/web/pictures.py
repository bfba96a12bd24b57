"""Pictures of the page for docs/images/page, of renders worth looking at: `make screenshots`.

python -m tests.web.pictures FOLDER
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from nocturne_client import Client

from examples.gallery import make_files
from tests.system.up import Up
from tests.system.waiting import wait_for
from tests.web.visit import NODE, ROOT

# Folder of examples, film, samples, and tags.
SCENES: tuple[tuple[str, tuple[int, int], int, list[str]], ...] = (
    ("prism", (480, 300), 64, ["dispersion"]),
    ("glossy_spheres", (480, 240), 64, ["materials"]),
    ("colour_chart", (360, 240), 64, ["colour"]),
    ("mixtures", (480, 300), 64, []),
)
SHOWN = ("cornell", (400, 400), (128, 32))
FRAMES = 4


def main() -> None:
    folder = Path(sys.argv[1]).absolute()
    with (
        tempfile.TemporaryDirectory(prefix="nocturne-p-") as place,
        Up(Path(place), 2, 1, "--core-hour-price", "0.04") as up,
    ):
        with Client(up.url) as client:
            given = renders(client)
        given |= {"url": up.url, "folder": str(folder)}
        environment = os.environ | {"NOCTURNE_PICTURES": json.dumps(given)}
        subprocess.run([NODE, ROOT / "tests/web/pictures.mjs"], env=environment, check=True)


def renders(client: Client) -> dict[str, str]:
    """Makes them, and waits for all."""
    name, film, samples = SHOWN
    made = []
    for scene, size, wanted, tags in SCENES:
        made.append(client.submit(_scene(scene), *size, wanted, tags=tags))
    for frame in range(FRAMES):
        turned = {"sensor.position[0]": 0.178 + 0.2 * frame / (FRAMES - 1)}
        title = f"Cornell box {frame + 1}"
        made.append(
            client.submit(_scene(name), 240, 240, 32, title, changes=turned, group="pan", tags=["film"])
        )
    other = client.submit(_scene(name), *film, samples[1], "Cornell box, draft")
    shown = client.submit(_scene(name), *film, samples[0], "Cornell box", layers=["albedo", "normal"])
    made += [other, shown]
    wait_for(lambda: all(client.get(each.id).has_ended for each in made), "renders to end", 900)
    return {"shown": shown.id, "other": other.id, "group": "pan"}


def _scene(name: str) -> Path:
    folder = ROOT / "examples" / name
    make_files(folder)
    return folder / "scene.json"


if __name__ == "__main__":
    main()
