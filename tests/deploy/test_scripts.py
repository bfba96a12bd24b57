"""Scripts of the deployment are clean, and the Slurm script starts and ends the right processes."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"

SCRIPTS = sorted([*DEPLOY.glob("**/*.sh"), *DEPLOY.glob("**/*.sbatch"), ROOT / ".ci" / "run"])


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_scripts_are_clean(script: Path) -> None:
    shell = "bash" if "bash" in script.read_text().splitlines()[0] else "sh"
    subprocess.run([shell, "-n", script], check=True, capture_output=True)
    # Unquoted lists in these scripts are meant to split into words: SC2086 is information.
    found = subprocess.run(
        [Path(sys.executable).with_name("shellcheck"), "--severity=warning", script],
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stdout


def _slurm(tmp_path: Path, worker: str, mode: int = 0o600, tunnel: str = "") -> "subprocess.Popen[str]":
    """The Slurm script with a tunnel and a worker that only print their arguments; the tunnel runs `tunnel`
    first, if given."""
    (tmp_path / "stunnel").mkdir()
    for name, text in (
        (
            "stunnel/start.sh",
            f'{tunnel}\necho "tunnel $NOCTURNE_TUNNEL_ACCEPT to $NOCTURNE_TUNNEL_CONNECT"; exec sleep 60',
        ),
        ("nocturne-worker", worker),
    ):
        (tmp_path / name).write_text(f"#!/bin/bash\n{text}\n")
        (tmp_path / name).chmod(0o755)
    settings = tmp_path / "settings"
    settings.write_text(
        "NOCTURNE_ASSETS=night.example:7071\nNOCTURNE_TUNNEL_CONNECT=night.example:6380\nNOCTURNE_TOKEN=nct_x\n"
        f"NOCTURNE_BIN={tmp_path}\nNOCTURNE_STUNNEL={tmp_path}/stunnel\n"
    )
    settings.chmod(mode)
    return subprocess.Popen(
        ["bash", DEPLOY / "slurm" / "workers.sbatch", settings],
        env={
            "PATH": "/usr/bin:/bin",
            "TMPDIR": str(tmp_path),
            "SLURM_JOB_ID": "77",
            "SLURM_ARRAY_JOB_ID": "70",
            "SLURM_ARRAY_TASK_ID": "7",
            "SLURM_CPUS_PER_TASK": "8",
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def test_the_slurm_script_starts_tunnel_and_worker(tmp_path: Path) -> None:
    said, _ = _slurm(tmp_path, 'sleep 0.5; echo "worker $* $NOCTURNE_TOKEN"; exit 5').communicate(timeout=30)
    assert f"tunnel {tmp_path}/nocturne-77/redis.sock to night.example:6380" in said
    assert f"--redis unix://{tmp_path}/nocturne-77/redis.sock --assets night.example:7071" in said
    assert "--enrol --id slurm-70-7" in said
    assert "--threads 8" in said
    assert "nct_x" in said


def test_a_signal_waits_for_the_worker(tmp_path: Path) -> None:
    worker = "trap 'sleep 1; echo handed back; exit 0' TERM; echo ready; while :; do sleep 0.1; done"
    process = _slurm(tmp_path, worker)
    assert process.stdout is not None
    while "ready" not in process.stdout.readline():
        pass
    process.terminate()
    said, _ = process.communicate(timeout=30)
    assert "handed back" in said
    assert process.returncode == 0
    assert list(tmp_path.glob("nocturne-77*")) == []


def test_a_signal_before_the_worker_runs_leaves_nothing_behind(tmp_path: Path) -> None:
    process = _slurm(tmp_path, "while :; do sleep 0.1; done", tunnel="kill -TERM $PPID")
    # Ends only when tunnel and worker have: they have its output.
    process.communicate(timeout=30)
    assert process.returncode in (0, 128 + signal.SIGTERM)
    assert list(tmp_path.glob("nocturne-77*")) == []


def test_settings_that_others_can_read_are_refused(tmp_path: Path) -> None:
    process = _slurm(tmp_path, "true", 0o644)
    said, _ = process.communicate(timeout=30)
    assert process.returncode == 2
    assert "holds secrets" in said
