"""A real Slurm of two nodes on this machine: munged, slurmctld and two slurmd, for as long as a test runs."""

import json
import os
import secrets
import shutil
import socket
import subprocess
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

import pytest

from tests.system.free_ports import free_port_pair
from tests.system.program import Program
from tests.system.waiting import wait_for

NODES = ("n1", "n2")
_GRACE_S = 60.0
_NEEDED = ("munged", "slurmctld", "slurmd", "sbatch")


class Cluster:
    """Partition `spare`, for whatever may be put off, and `urgent`, whose jobs put those off."""

    def __init__(self, folder: Path) -> None:
        """`folder` can be searched by anybody, as munge wants it. Skips without Slurm, or without root."""
        if os.geteuid() != 0 or not all(map(shutil.which, _NEEDED)):
            pytest.skip("needs root, and Debian's slurmctld, slurmd, slurm-client and munge")
        self.folder = folder
        self._programs: list[Program] = []
        self._config = folder / "slurm.conf"
        self._config.write_text(_config(folder))
        self._environment = {**os.environ, "SLURM_CONF": str(self._config)}

    def __enter__(self) -> Self:
        try:
            self._start_munge()
            self._start("slurmctld", "slurmctld", "-D", "-f", str(self._config))
            for node in NODES:
                self._start(node, "slurmd", "-D", "-N", node, "-f", str(self._config))
            wait_for(lambda: set(self.call("sinfo", "-h", "-o", "%T").split()) == {"idle"}, "both nodes")
        except BaseException:
            self._close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._close()

    def call(self, *words: str | Path) -> str:
        """What one of Slurm's commands prints; empty while it fails."""
        done = subprocess.run(
            [str(word) for word in words], env=self._environment, capture_output=True, text=True, check=False
        )
        return done.stdout.strip()

    def submit(self, *words: str | Path) -> str:
        """Of a batch job; gives its number. Its output goes into the folder."""
        job = self.call("sbatch", "--parsable", f"--output={self.folder}/job-%A_%a", *words)
        assert job.isdigit(), job
        return job

    def jobs(self, job: str) -> list[dict[str, Any]]:
        """All tasks of an array, as squeue knows them."""
        found = self.call("squeue", "--json", "--states=all")
        known: list[dict[str, Any]] = json.loads(found)["jobs"] if found else []
        return [each for each in known if job in (str(each["array_job_id"]), str(each["job_id"]))]

    def running(self, job: str) -> dict[str, str]:
        """The nodes of its tasks that run, by the number of each."""
        return {
            str(each["job_id"]): each["nodes"] for each in self.jobs(job) if each["job_state"] == "RUNNING"
        }

    def output(self) -> str:
        """What all jobs have printed."""
        return "\n".join(each.read_text(errors="replace") for each in sorted(self.folder.glob("job-*")))

    def _close(self) -> None:
        """Ends all jobs, then the cluster."""
        self.call("scancel", "--user=root")
        with suppress(AssertionError):
            wait_for(lambda: not self.call("squeue", "-h"), "all jobs to end", _GRACE_S)
        for program in reversed(self._programs):
            program.kill()

    def _start(self, name: str, command: str, *words: str) -> None:
        program = Program([shutil.which(command) or command, *words], self.folder / f"{name}.log")
        program.start()
        self._programs.append(program)

    def _start_munge(self) -> None:
        key, path = self.folder / "munge.key", self.folder / "munge.sock"
        key.write_bytes(secrets.token_bytes(1024))
        key.chmod(0o400)
        files = {
            "key-file": key.name,
            "socket": path.name,
            "pid-file": "munge.pid",
            "seed-file": "munge.seed",
        }
        places = [f"--{name}={self.folder / file}" for name, file in files.items()]
        self._start("munged", "munged", "--force", "--foreground", *places)
        wait_for(path.exists, "munged")


def _config(folder: Path) -> str:
    host, controller, ports = socket.gethostname(), free_port_pair(), free_port_pair()
    nodes = "".join(
        f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports + i} CPUs=2\n"
        for i, node in enumerate(NODES)
    )
    return f"""
ClusterName=night
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.sock
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
ReturnToService=2
MpiDefault=none
{nodes}PartitionName=spare Nodes={",".join(NODES)} Default=YES PriorityTier=1 State=UP
PartitionName=urgent Nodes={",".join(NODES)} PriorityTier=10 State=UP
"""
