"""What somebody needs to see a failure again: one file for each tile that failed."""

import json
import zipfile
from pathlib import Path

from google.protobuf.json_format import MessageToJson
from nocturne_scene.ranges import SampleRange
from nocturne_scene.replacing import replacing

from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.dispatch.records import FailedTile
from nocturne_coordinator.store.data_folder import DataFolder, make_folders

_README = """\
Tile {tile}, samples {first} to {end} of render {render} failed on: {workers}.

    {reason}

To see it again, with the blobs of the service's data folder:

    nocturne-trace scene.pb --job job.pb --blobs DATA/blobs -o sums.bin

scene.json  the scene document            scene.pb  compiled
job.json    the job that failed           job.pb    the same, as workers get it
schedule.pb     of the whole image            failure.json  the reasons
"""


def write_bundle(folder: DataFolder, render: PlannedRender, failed: FailedTile) -> Path:
    """Writes it next to the render's images, whole or not at all; OSError where that can't be done."""
    target = folder.bundle_path(render.id, failed.tile_index)
    make_folders(target)
    planned = render.ranges_of(failed.tile_index).find(failed.first_sample, failed.end_sample)
    job = render.job(failed.tile_index, planned or SampleRange(0, failed.first_sample, failed.end_sample))
    failure = {"reason": failed.reason, "workers": failed.workers}
    words = _README.format(
        tile=failed.tile_index,
        first=failed.first_sample,
        end=failed.end_sample,
        render=render.id,
        workers=", ".join(failed.workers),
        reason=failed.reason,
    )
    with (
        replacing(target) as unfinished,
        zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as bundle,
    ):
        bundle.writestr("README.txt", words)
        bundle.writestr("job.json", MessageToJson(job))
        bundle.writestr("job.pb", job.SerializeToString(deterministic=True))
        bundle.writestr("schedule.pb", render.schedule.SerializeToString(deterministic=True))
        bundle.writestr("failure.json", json.dumps(failure))
        bundle.writestr("scene.json", folder.renders.scene_document(render.id))
        scene = render.scene.hex()
        if folder.blobs.has(scene):
            bundle.write(folder.blobs.path(scene), "scene.pb")
    return target
