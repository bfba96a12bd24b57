"""No compiled scene and no job, however wrong, crashes the program that reads it."""

import json
import os
import random
import subprocess
from pathlib import Path

import pytest
from nocturne.v1 import job_pb2, scene_pb2
from nocturne_client.local.programs import need_program
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.tile_sums import numbers_in

from tests.mutations import mutated

pytestmark = pytest.mark.system

TRIES = int(os.environ.get("NOCTURNE_FUZZ_TRIES", "25"))
"""Of each scene; `make fuzz` makes many more."""
FIRST_SEED = int(os.environ.get("NOCTURNE_FUZZ_SEED", "1"))

ROOT = Path(__file__).parents[2]
_SCENES = ("cornell", "fog", "prism", "reflector", "subsurface")
_MEMORY_BYTES = 8 * 1024**3
# Work that a scene may ask for is bounded elsewhere: here it is cut off, which is no crash.
_SECONDS = 20
_JOB = job_pb2.Job(
    render_id="r-any",
    tile=job_pb2.Tile(x=0, y=0, width=4, height=4),
    end_sample=1,
    scene=bytes(32),
    film_width=16,
    film_height=16,
    engine=job_pb2.ENGINE_CURRENT,
)


class Reader:
    """nocturne-trace on one scene, in bounds of memory and time."""

    def __init__(self, folder: Path, scene: str) -> None:
        self.folder = folder
        document = check_document(json.loads((ROOT / "examples" / scene / "scene.json").read_text()))
        blobs = BlobStore(folder / "blobs")
        sha256 = compile_scene(document, blobs).scene_sha256
        self.scene = scene_pb2.CompiledScene.FromString(blobs.path(sha256).read_bytes())

    def status(self, scene: bytes, job: bytes) -> tuple[int, str]:
        """Exit status, negative for a signal, and the program's message; 0 if it takes too long."""
        (self.folder / "scene.pb").write_bytes(scene)
        (self.folder / "job.pb").write_bytes(job)
        try:
            done = subprocess.run(
                [
                    # Not between fork and exec, which threads of gRPC do not survive that other tests start.
                    *("prlimit", f"--as={_MEMORY_BYTES}"),
                    *(need_program("nocturne-trace"), self.folder / "scene.pb", "--threads", "1"),
                    *("--blobs", self.folder / "blobs", "--job", self.folder / "job.pb"),
                    *("-o", self.folder / "sums"),
                ],
                capture_output=True,
                timeout=_SECONDS,
            )
        except subprocess.TimeoutExpired:
            return 0, "took too long"
        return done.returncode, done.stderr.decode(errors="replace")


@pytest.fixture(scope="module", params=_SCENES)
def reader(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Reader:
    return Reader(tmp_path_factory.mktemp(request.param), request.param)


def test_the_right_bytes_are_traced(reader: Reader) -> None:
    status, said = reader.status(reader.scene.SerializeToString(), _JOB.SerializeToString())
    assert (status, said) == (0, "")
    further = len(reader.scene.sensor.further_responses)
    assert (reader.folder / "sums").stat().st_size == 8 * numbers_in(4, 4, further)


def test_wrong_bytes_are_refused_in_words(reader: Reader) -> None:
    refused = 0
    for seed in range(FIRST_SEED, FIRST_SEED + TRIES):
        random_ = random.Random(seed)
        scene, job = reader.scene.SerializeToString(), _JOB.SerializeToString()
        if random_.random() < 0.8:
            scene = mutated(reader.scene, random_)
        else:
            job = mutated(_JOB, random_)
        status, said = reader.status(scene, job)
        assert status in (0, 2), f"seed {seed}: status {status}, {said}"
        refused += status == 2
        assert status == 0 or said.strip(), f"seed {seed}: refused without a word"
    # Otherwise nothing was wrong, and nothing was tested.
    assert refused > TRIES // 10
