"""deploy/slurm on a real Slurm of two nodes: arrays, jobs of higher priority, requeues and drained nodes."""

import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.slurm.cluster import NODES, Cluster
from tests.system.guarded_service import GuardedService
from tests.system.images import Image, differing_values
from tests.system.renders import finished_image, submit, wait_for_more_ranges
from tests.system.tunnel import NAME, certificate, needs_stunnel
from tests.system.waiting import wait_for

pytestmark = [pytest.mark.slurm, pytest.mark.system, needs_stunnel]

_ROOT = Path(__file__).parents[2]
_DEPLOY = _ROOT / "deploy"
_WORKERS = _DEPLOY / "slurm" / "workers.sbatch"
_FOR_TWO = ("--array=1-2", "--cpus-per-task=2", "--mem-per-cpu=0", "--time=10")
_LIMIT_S = 240.0


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[GuardedService]:
    running = GuardedService(tmp_path_factory.mktemp("g"))
    yield running
    running.close()


@pytest.fixture(scope="module")
def cluster() -> Iterator[Cluster]:
    with tempfile.TemporaryDirectory(prefix="nocturne-slurm-") as folder:
        Path(folder).chmod(0o755)
        with Cluster(Path(folder)) as made:
            print(made.call("sbatch", "--version"))  # noqa: T201
            yield made


@pytest.fixture(scope="module")
def settings(service: GuardedService, cluster: Cluster) -> Path:
    """As a person fills in deploy/slurm/settings.example."""
    pair = certificate(service.authority, service.folder, "slurm")
    values = {
        "NOCTURNE_ASSETS": f"localhost:{service.port + 1}",
        "NOCTURNE_ASSETS_CA": service.trusted,
        "NOCTURNE_TOKEN": service.tokens["worker"],
        "NOCTURNE_TUNNEL_CONNECT": f"127.0.0.1:{service.tunnel_entrance}",
        "NOCTURNE_TUNNEL_NAME": NAME,
        "NOCTURNE_TUNNEL_CERTIFICATE": pair[0],
        "NOCTURNE_TUNNEL_KEY": pair[1],
        "NOCTURNE_TUNNEL_AUTHORITY": service.trusted,
    }
    example = (_DEPLOY / "slurm" / "settings.example").read_text()
    assert all(f"\n{name}=" in example for name in values)
    values |= {
        "NOCTURNE_BIN": _ROOT / "build" / "release" / "worker",
        "NOCTURNE_STUNNEL": _DEPLOY / "stunnel",
        "TMPDIR": cluster.folder,
    }
    file = cluster.folder / "settings"
    file.write_text("".join(f"{name}={value}\n" for name, value in values.items()))
    file.chmod(0o600)
    return file


def _urgent(cluster: Cluster, node: str) -> str:
    """A job that takes a whole node for some seconds."""
    return cluster.submit("--partition=urgent", f"--nodelist={node}", "--exclusive", "--wrap=sleep 3")


def _both_run(cluster: Cluster, job: str) -> None:
    wait_for(lambda: len(cluster.running(job)) == 2, "both tasks to run", _LIMIT_S)


def test_the_image_is_that_of_a_run_alone_whatever_slurm_does(
    service: GuardedService, cluster: Cluster, settings: Path, traced_alone: Image
) -> None:
    array = cluster.submit(*_FOR_TWO, _WORKERS, settings)
    _both_run(cluster, array)
    render_id = submit(service.client)
    wait_for_more_ranges(service.client, render_id, 1, _LIMIT_S)
    # A job of higher priority takes a node; the worker there hands its job back and is queued again.
    first, second = cluster.running(array)
    urgent = _urgent(cluster, cluster.running(array)[first])
    wait_for(lambda: urgent in cluster.running(urgent), "the urgent job", _LIMIT_S)
    wait_for_more_ranges(service.client, render_id, 1, _LIMIT_S)
    # The other is put back by hand, and then a node is drained in mid-job.
    cluster.call("scontrol", "requeue", second)
    wait_for(lambda: bool(cluster.running(array)), "a task to run again", _LIMIT_S)
    wait_for_more_ranges(service.client, render_id, 1, _LIMIT_S)
    node = next(iter(cluster.running(array).values()), NODES[0])
    cluster.call("scontrol", "update", f"nodename={node}", "state=drain", "reason=test")
    image = finished_image(service.client, render_id)
    assert differing_values(image, traced_alone) == {}
    cluster.call("scontrol", "update", f"nodename={node}", "state=resume")
    _both_run(cluster, array)
    cluster.call("scancel", array)
    wait_for(lambda: not cluster.running(array), "the tasks to end", _LIMIT_S)


def test_a_task_that_is_told_to_end_leaves_nothing(
    service: GuardedService, cluster: Cluster, settings: Path
) -> None:
    array = cluster.submit(*_FOR_TWO, _WORKERS, settings)
    _both_run(cluster, array)
    wanted = {f"night-{array}-1", f"night-{array}-2"}

    def both_are_known() -> bool:
        return {each.id.rpartition("/")[2] for each in service.client.workers()} >= wanted

    wait_for(both_are_known, "both workers", _LIMIT_S)
    cluster.call("scancel", "--signal=TERM", "--batch", array)
    wait_for(lambda: not cluster.running(array), "the tasks to end", _LIMIT_S)
    assert {each["job_state"] for each in cluster.jobs(array)} == {"COMPLETED"}, cluster.output()
    assert list(cluster.folder.glob("nocturne-*")) == []
    left = ["pgrep", "--full", f"nocturne-worker.*{cluster.folder}"]
    wait_for(lambda: subprocess.run(left, check=False).returncode == 1, "all processes to end")
