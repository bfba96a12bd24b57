"""`nocturne openjd` and `nocturne join`: a render as tasks of any queue, without a service.

A job folder has all that a task needs. A task is a call of `nocturne-trace --part`; the last one joins the
sums of all to the image that one process would make, in every bit. The folder's template is of Open Job
Description, version 2023-09 (https://github.com/OpenJobDescription/openjd-specifications).
"""

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder
from nocturne_client.local.image_error import ImageError
from nocturne_client.local.programs import need_program
from nocturne_client.local.render import check_outputs, finish_image

TEMPLATE = "template.json"
_FILES = "scene.pb", "schedule.pb", "blobs"
_SUMS, _LAYERS = "sums", "layers"


def write_template(compiled: CompiledFolder, name: str, parts: int) -> Path:
    """Completes a folder that a scene was compiled to; `parts`: tasks that trace."""
    folder = compiled.scene.parent
    if compiled.layers is not None:
        (folder / _LAYERS).write_bytes(compiled.layers.read_bytes())
    path = folder / TEMPLATE
    path.write_text(json.dumps(_template(name, parts), indent=2) + "\n")
    return path


def join(folder: Path, outputs: Sequence[Path]) -> ImageError:
    """Writes the image of all parts. NocturneClientError where one is missing or not of this job."""
    check_outputs(outputs)
    scene, schedule, blobs = (folder / name for name in _FILES)
    image = folder / "image.part.exr"
    command = [str(need_program("nocturne-trace")), str(scene), "--schedule", str(schedule)]
    command += ["--blobs", str(blobs), "--join", str(folder / _SUMS), "-o", str(image), "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
    if done.returncode != 0:
        raise NocturneClientError(done.stderr.strip().removeprefix("nocturne-trace: "))
    try:
        layers = folder / _LAYERS
        return finish_image(image, layers if layers.exists() else None, outputs)
    finally:
        image.unlink()


def _template(name: str, parts: int) -> dict[str, Any]:
    files = [f"{{{{Param.Folder}}}}/{each}" for each in _FILES]
    return {
        "specificationVersion": "jobtemplate-2023-09",
        "name": name,
        "parameterDefinitions": [
            {
                "name": "Folder",
                "type": "PATH",
                "objectType": "DIRECTORY",
                "dataFlow": "INOUT",
                "default": ".",
            },
            {"name": "Trace", "type": "STRING", "default": "nocturne-trace"},
            {"name": "Nocturne", "type": "STRING", "default": "nocturne"},
        ],
        "steps": [
            {
                "name": "Trace",
                "parameterSpace": {
                    "taskParameterDefinitions": [{"name": "Part", "type": "INT", "range": f"0-{parts - 1}"}]
                },
                "script": _run(
                    "{{Param.Trace}}",
                    *(files[0], "--schedule", files[1], "--blobs", files[2], "--quiet"),
                    *("--part", f"{{{{Task.Param.Part}}}},{parts}", "-o", f"{{{{Param.Folder}}}}/{_SUMS}"),
                ),
            },
            {
                "name": "Join",
                "dependencies": [{"dependsOn": "Trace"}],
                "script": _run(
                    *("{{Param.Nocturne}}", "join", "{{Param.Folder}}"),
                    *("-o", "{{Param.Folder}}/image.exr", "-o", "{{Param.Folder}}/image.png"),
                ),
            },
        ],
    }


def _run(command: str, *words: str) -> dict[str, Any]:
    return {"actions": {"onRun": {"command": command, "args": [*words]}}}
