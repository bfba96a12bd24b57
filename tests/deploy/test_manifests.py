"""Kubernetes, Slurm, Prometheus and Grafana files say what our programs understand."""

import json
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml
from nocturne_api import main as api_main
from nocturne_api.operations.prometheus import metrics_text
from nocturne_client.local.programs import need_program
from nocturne_coordinator import main as coordinator_main
from nocturne_coordinator.store.data_folder import DataFolder

from tests.deploy.test_images import STAGES, version

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"
KUBERNETES = DEPLOY / "kubernetes"
OVERLAYS = sorted(path.name for path in (KUBERNETES / "overlays").iterdir())
# The newest that the schemas are here for, and an older one that knows sidecars.
VERSIONS = ("1.29", "1.34", kubernetes_validate.latest_version())
# Not Kubernetes' own: checked below.
_ELSEWHERE = {"ScaledObject", "Kustomization"}

needs_kubectl = pytest.mark.skipif(shutil.which("kubectl") is None, reason="kubectl is not installed")


def base() -> list[dict[str, Any]]:
    files = yaml.safe_load((KUBERNETES / "base" / "kustomization.yaml").read_text())["resources"]
    return [
        document
        for file in files
        for document in yaml.safe_load_all((KUBERNETES / "base" / file).read_text())
    ]


@cache
def overlay(name: str) -> list[dict[str, Any]]:
    made = subprocess.run(
        ["kubectl", "kustomize", KUBERNETES / "overlays" / name], capture_output=True, text=True, check=False
    )
    assert made.returncode == 0, made.stderr
    return list(yaml.safe_load_all(made.stdout))


def pods(documents: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Pod templates by name of what makes them."""
    return {
        each["metadata"]["name"]: each["spec"]["template"]
        for each in documents
        if each["kind"] in ("Deployment", "StatefulSet")
    }


def containers(documents: list[dict[str, Any]]) -> Iterator[tuple[str, dict[str, Any], dict[str, Any]]]:
    """Name, container and pod of all."""
    for name, template in pods(documents).items():
        spec = template["spec"]
        for container in [*spec.get("initContainers", []), *spec["containers"]]:
            yield f"{name}/{container['name']}", container, spec


def _validate(documents: list[dict[str, Any]], version: str) -> None:
    for document in documents:
        if document["kind"] not in _ELSEWHERE:
            kubernetes_validate.validate(document, version, strict=True)


@pytest.mark.parametrize("release", VERSIONS)
def test_the_base_is_by_kubernetes_schemas(release: str) -> None:
    _validate(base(), release)


@needs_kubectl
@pytest.mark.parametrize("release", VERSIONS)
@pytest.mark.parametrize("name", OVERLAYS)
def test_overlays_are_by_kubernetes_schemas(name: str, release: str) -> None:
    documents = overlay(name)
    assert {"Deployment", "StatefulSet", "Service", "NetworkPolicy"} <= {each["kind"] for each in documents}
    _validate(documents, release)


def test_a_wrong_manifest_is_found() -> None:
    wrong = base()
    wrong[1]["spec"]["replcas"] = 3
    with pytest.raises(kubernetes_validate.ValidationError):
        _validate(wrong, VERSIONS[-1])


def test_containers_are_contained() -> None:
    found = list(containers(base()))
    assert len(found) == 6
    for name, container, spec in found:
        assert spec["securityContext"]["runAsNonRoot"] is True, name
        assert spec["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}, name
        assert spec["automountServiceAccountToken"] is False, name
        assert container["securityContext"] == {
            "allowPrivilegeEscalation": False,
            "readOnlyRootFilesystem": True,
            "capabilities": {"drop": ["ALL"]},
        }, name
        assert container["resources"]["limits"]["memory"], name
        image, _, tag = container["image"].removeprefix("nocturne-").partition(":")
        assert image in STAGES, name
        assert tag == version(), name
        places = {mount["name"] for mount in container["volumeMounts"]}
        claims = {"data"} if name.startswith("nocturne/") else set()
        assert places <= {volume["name"] for volume in spec["volumes"]} | claims, name


def _arguments(name: str) -> list[str]:
    found = {key: container for key, container, _ in containers(base())}
    arguments: list[str] = found[name]["args"]
    return arguments


def test_arguments_are_understood(monkeypatch: pytest.MonkeyPatch) -> None:
    options = coordinator_main._parser().parse_args(_arguments("nocturne/coordinator"))
    assert str(options.data) == "/data"
    monkeypatch.setattr(sys, "argv", ["nocturne-api", *_arguments("nocturne/api")])
    settings = api_main._settings()
    assert (settings.auth, settings.any_address) == (True, False)
    assert settings.tls_certificate is not None
    known = subprocess.run(
        [need_program("nocturne-worker"), "--help"], check=True, capture_output=True, text=True
    )
    for argument in _arguments("nocturne-worker/worker"):
        assert f"{argument.split('=')[0]} " in known.stdout, argument


def test_workers_may_be_taken_away() -> None:
    worker = pods(base())["nocturne-worker"]["spec"]
    # Longer than the worker's own grace, 25 s.
    assert worker["terminationGracePeriodSeconds"] > 30
    assert worker["priorityClassName"] == "nocturne-worker"
    assert not any("persistentVolumeClaim" in volume for volume in worker["volumes"])
    assert {each["key"] for each in worker["tolerations"]} >= {"cloud.google.com/gke-spot"}
    # The tunnel outlives the worker: a sidecar, which Kubernetes ends last.
    assert [each["restartPolicy"] for each in worker["initContainers"]] == ["Always"]


def test_every_part_is_looked_after() -> None:
    for name, container, _ in containers(base()):
        part = name.partition("/")[2]
        if part != "tunnel":
            assert "livenessProbe" in container, name
    probe = {name: each for name, each, _ in containers(base())}["nocturne/coordinator"]["livenessProbe"]
    arguments = _arguments("nocturne/coordinator")
    # The probe looks at the file that the coordinator keeps fresh.
    assert probe["exec"]["command"][:2] == ["is-fresh", arguments[arguments.index("--alive") + 1]]


def test_services_find_their_pods_and_policies_too() -> None:
    labels = [template["metadata"]["labels"] for template in pods(base()).values()]
    for document in base():
        if document["kind"] == "Service":
            wanted = document["spec"]["selector"]
        elif document["kind"] == "PodDisruptionBudget":
            wanted = document["spec"]["selector"]["matchLabels"]
        elif document["kind"] == "NetworkPolicy":
            wanted = document["spec"]["podSelector"]["matchLabels"]
        else:
            continue
        assert wanted in labels, document["metadata"]["name"]


def test_the_tunnel_has_all_that_its_files_ask_for() -> None:
    for name, end in (("nocturne-redis/tunnel", "server"), ("nocturne-worker/tunnel", "client")):
        container = {key: each for key, each, _ in containers(base())}[name]
        assert container["args"] == [end]
        asked = set(re.findall(r"\$\{(\w+)\}", (DEPLOY / "stunnel" / f"{end}.conf").read_text()))
        assert asked <= {each["name"] for each in container["env"]}


# --- what is counted ---


def metric_names(tmp_path: Path) -> set[str]:
    folder = DataFolder(tmp_path / "data")
    try:
        return set(re.findall(r"^(nocturne_\w+)", metrics_text(folder).decode(), re.MULTILINE))
    finally:
        folder.close()


def _named(text: str) -> set[str]:
    return set(re.findall(r"\bnocturne_\w+", text))


def _dashboards() -> list[Path]:
    return sorted((DEPLOY / "grafana" / "dashboards").glob("*.json"))


def test_metrics_that_are_shown_or_watched_are_there(tmp_path: Path) -> None:
    there = metric_names(tmp_path)
    assert "nocturne_backlog_ranges" in there
    shown: set[str] = set()
    for path in _dashboards():
        for panel in json.loads(path.read_text())["panels"]:
            for target in panel["targets"]:
                shown |= _named(target["expr"])
    alerts = yaml.safe_load((DEPLOY / "prometheus" / "alerts.yml").read_text())
    watched = {name for group in alerts["groups"] for rule in group["rules"] for name in _named(rule["expr"])}
    scaled = yaml.safe_load((KUBERNETES / "overlays" / "autoscaled" / "scaled-object.yaml").read_text())
    scales = {name for trigger in scaled["spec"]["triggers"] for name in _named(trigger["metadata"]["query"])}
    assert scales == {"nocturne_backlog_ranges"}
    assert shown
    assert watched
    assert (shown | watched | scales) - there == set()


def test_dashboards_are_what_grafana_takes() -> None:
    uids = set()
    for path in _dashboards():
        board = json.loads(path.read_text())
        uids.add(board["uid"])
        ids = [panel["id"] for panel in board["panels"]]
        assert len(set(ids)) == len(ids)
        taken: set[tuple[int, int]] = set()
        for panel in board["panels"]:
            assert panel["datasource"] == {"type": "prometheus", "uid": "prometheus"}
            place = panel["gridPos"]
            cells = {
                (x, y)
                for x in range(place["x"], place["x"] + place["w"])
                for y in range(place["y"], place["y"] + place["h"])
            }
            assert not cells & taken, panel["title"]
            assert max(x for x, _ in cells) < 24
            taken |= cells
    assert len(uids) == len(_dashboards()) == 2
    sources = yaml.safe_load((DEPLOY / "grafana/provisioning/datasources/prometheus.yml").read_text())
    assert [each["uid"] for each in sources["datasources"]] == ["prometheus"]


def test_the_scaled_object_scales_workers() -> None:
    scaled = yaml.safe_load((KUBERNETES / "overlays" / "autoscaled" / "scaled-object.yaml").read_text())
    spec = scaled["spec"]
    assert spec["scaleTargetRef"]["name"] in pods(base())
    assert spec["minReplicaCount"] == 0 < spec["fallback"]["replicas"] < spec["maxReplicaCount"]


@needs_kubectl
def test_who_scales_is_the_only_one_who_does() -> None:
    worker = next(
        each
        for each in overlay("autoscaled")
        if each["kind"] == "Deployment" and each["metadata"]["name"] == "nocturne-worker"
    )
    assert "replicas" not in worker["spec"]


def test_compose_has_what_watches_it() -> None:
    compose = yaml.safe_load((ROOT / "docker-compose.yml").read_text())
    watched = {name for name, each in compose["services"].items() if each.get("profiles") == ["watched"]}
    assert watched == {"prometheus", "grafana"}
    for name, service in compose["services"].items():
        for volume in service.get("volumes", []):
            source = volume.split(":")[0]
            if source.startswith("./"):
                assert (ROOT / source).exists(), name
            elif source != volume:
                assert source in compose["volumes"], name
        for port in service.get("ports", []):
            assert port.startswith("127.0.0.1:"), name
        assert service["cap_drop"] == ["ALL"], name
        assert service["read_only"] is True, name
    home = compose["services"]["grafana"]["environment"]["GF_DASHBOARDS_DEFAULT_HOME_DASHBOARD_PATH"]
    assert Path(home).name in {path.name for path in _dashboards()}
    scraped = yaml.safe_load((DEPLOY / "prometheus" / "prometheus.yml").read_text())["scrape_configs"]
    assert scraped[0]["static_configs"] == [{"targets": ["api:7070"]}]
    assert "7070" in compose["services"]["api"]["command"]


# --- scripts ---

SCRIPTS = sorted([*DEPLOY.glob("**/*.sh"), *DEPLOY.glob("**/*.sbatch"), ROOT / ".ci" / "run"])


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_scripts_are_clean(script: Path) -> None:
    shell = "bash" if "bash" in script.read_text().splitlines()[0] else "sh"
    subprocess.run([shell, "-n", script], check=True, capture_output=True)
    # Lists of words are words of their own in these scripts where there are no quotes: SC2086 is information.
    found = subprocess.run(
        [Path(sys.executable).with_name("shellcheck"), "--severity=warning", script],
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stdout


def _slurm(tmp_path: Path, worker: str, mode: int = 0o600, tunnel: str = "") -> "subprocess.Popen[str]":
    """The Slurm script with a tunnel and a worker that only say what they were asked; the tunnel does
    something else first, if wanted."""
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
    assert "tunnel 127.0.0.1:20077 to night.example:6380" in said
    assert "--redis tcp://127.0.0.1:20077 --assets night.example:7071 --id slurm-70-7" in said
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
