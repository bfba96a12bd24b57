"""What the development environment needs: all that the packages ask for, and their programs.

They are scene/, services/client/ and services/api/, each with a pyproject.toml. Read by hatchling.
"""

import tomllib
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

PACKAGES = ("scene", "services/api", "services/client", "worker")


class Together(MetadataHookInterface):
    """Dependencies and programs of the packages."""

    def update(self, metadata: dict[str, Any]) -> None:
        wanted: set[str] = set()
        scripts: dict[str, str] = {}
        for folder in PACKAGES:
            project = tomllib.loads((Path(self.root) / folder / "pyproject.toml").read_text())["project"]
            # What `nocturne[all]` brings is here, too.
            asked = [
                *project.get("dependencies", ()),
                *project.get("optional-dependencies", {}).get("all", ()),
            ]
            wanted |= {each for each in asked if not each.startswith("nocturne")}
            scripts |= project.get("scripts", {})
        metadata["dependencies"] = sorted(wanted)
        metadata["scripts"] = scripts
