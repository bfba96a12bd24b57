"""Kubernetes files say what our programs understand."""

import re
import shutil
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
from nocturne_client.local.programs import need_program
from nocturne_coordinator import main as coordinator_main

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


def _value(arguments: list[str], option: str) -> str:
    return next(each.partition("=")[2] for each in arguments if each.startswith(f"{option}="))


def test_arguments_are_understood(monkeypatch: pytest.MonkeyPatch) -> None:
    options = coordinator_main._parser().parse_args(_arguments("nocturne/coordinator"))
    assert str(options.data) == "/data/nocturne"
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
    # Longer than the two seconds in which a worker hands its jobs back.
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
    assert probe["exec"]["command"][:2] == ["is-fresh", _value(arguments, "--alive")]


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


def test_workers_have_a_disruption_budget() -> None:
    budgets = [each["spec"] for each in base() if each["kind"] == "PodDisruptionBudget"]
    of_workers = {"matchLabels": pods(base())["nocturne-worker"]["metadata"]["labels"]}
    assert [(each["selector"], each["maxUnavailable"]) for each in budgets] == [(of_workers, "50%")]


def test_the_tunnel_has_all_that_its_files_ask_for() -> None:
    for name, end in (("nocturne-redis/tunnel", "server"), ("nocturne-worker/tunnel", "client")):
        container = {key: each for key, each, _ in containers(base())}[name]
        assert container["args"] == [end]
        asked = set(re.findall(r"\$\{(\w+)\}", (DEPLOY / "stunnel" / f"{end}.conf").read_text()))
        assert asked <= {each["name"] for each in container["env"]}


def test_nobody_reaches_redis_without_tls() -> None:
    found = {name: each for name, each, _ in containers(base())}
    redis, tunnel = found["nocturne-redis/redis"], found["nocturne-redis/tunnel"]
    assert redis["args"][:2] == ["--bind", "127.0.0.1"]
    assert "ports" not in redis
    accept = next(each["value"] for each in tunnel["env"] if each["name"] == "NOCTURNE_TUNNEL_ACCEPT")
    policies = [each for each in base() if each["kind"] == "NetworkPolicy"]
    policy = next(each for each in policies if each["metadata"]["name"] == "nocturne-redis")
    assert [rule["ports"] for rule in policy["spec"]["ingress"]] == [[{"port": int(accept)}]]
    address = _value(_arguments("nocturne/coordinator"), "--redis")
    assert address.startswith(f"rediss://nocturne-redis:{accept}?")
    # What the address names is mounted.
    files = re.findall(r"=(/[^/&]+)/[^&]+", address.partition("?")[2])
    mounts = {mount["mountPath"] for mount in found["nocturne/coordinator"]["volumeMounts"]}
    assert len(files) == 3
    assert set(files) <= mounts


def test_a_worker_reaches_redis_by_its_own_end_of_the_tunnel() -> None:
    tunnels = {
        name: {each["name"]: each["value"] for each in container["env"] if "value" in each}
        for name, container, _ in containers(base())
        if name.endswith("/tunnel")
    }
    own, far = tunnels["nocturne-worker/tunnel"], tunnels["nocturne-redis/tunnel"]
    assert own["NOCTURNE_TUNNEL_ACCEPT"].startswith("127.0.0.1:")
    address = _value(_arguments("nocturne-worker/worker"), "--redis")
    assert address == f"tcp://{own['NOCTURNE_TUNNEL_ACCEPT']}"
    assert own["NOCTURNE_TUNNEL_CONNECT"] == f"nocturne-redis:{far['NOCTURNE_TUNNEL_ACCEPT']}"
    assert far["NOCTURNE_TUNNEL_CONNECT"].startswith("127.0.0.1:")


def test_each_role_has_a_certificate_of_its_own() -> None:
    """Else who breaks into a worker has the keys of Redis and of the API."""
    found = {
        name: [volume["secret"]["secretName"] for volume in template["spec"]["volumes"] if "secret" in volume]
        for name, template in pods(base()).items()
    }
    assert sorted(found) == ["nocturne", "nocturne-redis", "nocturne-worker"]
    assert all(len(secrets) == 1 for secrets in found.values())
    assert len({secrets[0] for secrets in found.values()}) == len(found)


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
