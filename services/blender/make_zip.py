"""Makes the add-on's zip: `python services/blender/make_zip.py FOLDER`.

The same files give the same bytes.
"""

import sys
import tomllib
import zipfile
from pathlib import Path

_SOURCES = Path(__file__).parent / "nocturne_blender"
_LICENSE = Path(__file__).parents[2] / "LICENSE"
# The oldest time that a zip can hold.
_TIME = (1980, 1, 1, 0, 0, 0)


def make(folder: Path) -> Path:
    """Writes NAME-VERSION.zip as Blender's extensions are; gives its path."""
    manifest = tomllib.loads((_SOURCES / "blender_manifest.toml").read_text())
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"nocturne-blender-{manifest['version']}.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in (_LICENSE, *sorted(_SOURCES.glob("*.py")), _SOURCES / "blender_manifest.toml"):
            archive.writestr(zipfile.ZipInfo(file.name, _TIME), file.read_bytes(), zipfile.ZIP_DEFLATED)
    return path


if __name__ == "__main__":
    make(Path(sys.argv[1]))
