"""The container images have all packages that their programs need: the Dockerfile compared with the built
programs."""

import json
import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[2]
PROGRAMS = ROOT / "build" / "release" / "worker"

Stages = dict[str, list[str]]


def instructions() -> Stages:
    """The Dockerfile's instructions by stage, FROM first, continued lines joined."""
    text = (ROOT / "deploy" / "Dockerfile").read_text().replace("\\\n", " ")
    stages: Stages = {}
    for line in (line for line in text.splitlines() if line and not line.startswith("#")):
        if made := re.fullmatch(r"FROM (\S+) AS (\S+)", line):
            stages[made[2]] = [line]
        elif stages:
            next(reversed(stages.values())).append(line)
    return stages


STAGES = instructions()


def lineage(stage: str) -> list[str]:
    """All instructions that a stage is made by, those of the stages that it starts from included."""
    before = STAGES[stage][0].split()[1]
    return [*(lineage(before) if before in STAGES else []), *STAGES[stage]]


def roles(stage: str) -> set[str]:
    """Roles of Debian packages that a stage has."""
    found = re.findall(r"debian-packages\.sh ([a-z ]+)\)", "\n".join(lineage(stage)))
    return {role for words in found for role in words.split()}


def packages(stage: str) -> set[str]:
    words = [str(ROOT / "deploy" / "debian-packages.sh"), *sorted(roles(stage))]
    return set(subprocess.run(words, check=True, capture_output=True, text=True).stdout.split())


def built_targets() -> set[str]:
    made = re.search(r"cmake --build \S+ +--target ([\w -]+?) &&", "\n".join(STAGES["programs"]))
    assert made is not None
    return set(made[1].split())


def declared_targets() -> set[str]:
    """Programs of the CMake files."""
    text = (ROOT / "worker" / "apps" / "CMakeLists.txt").read_text()
    return set(re.findall(r"add_executable\(([\w-]+)", text))


def test_all_programs_are_built() -> None:
    assert built_targets() == declared_targets()
    assert {path.name for path in PROGRAMS.iterdir()} == built_targets()


def copied_from_programs(stage: str) -> set[str]:
    """What an image takes of that which was built."""
    names: set[str] = set()
    for source in re.findall(r"COPY --from=programs (\S+) /usr/local/bin/", "\n".join(lineage(stage))):
        names |= {path.name for path in PROGRAMS.iterdir()} if source.endswith("/") else {Path(source).name}
    return names


def test_images_have_the_programs_that_their_code_starts() -> None:
    started = set()
    for path in [
        *ROOT.glob("scene/**/*.py"),
        *ROOT.glob("coordinator/**/*.py"),
        *ROOT.glob("services/api/**/*.py"),
    ]:
        started |= set(re.findall(r'"(nocturne-(?:grid|trace|worker))"', path.read_text()))
    assert started == {"nocturne-grid", "nocturne-trace"}
    assert started <= copied_from_programs("api")
    assert {path.name for path in PROGRAMS.iterdir()} == copied_from_programs("worker")


@cache
def needed_packages(program: Path) -> frozenset[str]:
    """Debian packages of the libraries that a file names itself; those packages bring their own
    dependencies."""
    said = subprocess.run(["readelf", "-d", program], check=True, capture_output=True, text=True).stdout
    linked = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    names = re.findall(r"NEEDED.*\[(.+)\]", said)
    places = [re.search(rf"{re.escape(name)} => (\S+)", linked) for name in names]
    files = [str(Path(place[1]).resolve()) for place in places if place]
    # Packages still name files of /usr/lib by /lib.
    either = [path for file in files for path in (file, file.removeprefix("/usr"))]
    told = subprocess.run(["dpkg", "-S", *either], check=False, capture_output=True, text=True).stdout
    owners = {path: owner.split(":")[0] for owner, path in re.findall(r"^(\S+): (\S+)$", told, re.MULTILINE)}
    found = {file: owners.get(file) or owners.get(file.removeprefix("/usr")) for file in files}
    assert None not in found.values(), f"of no package: {found}"
    return frozenset(owner for owner in found.values() if owner)


@cache
def depends_on() -> dict[str, list[str]]:
    """Of every package here, the names that it depends on, alternatives included."""
    command = ["dpkg-query", "-W", "-f", "${Package}\t${Depends}, ${Pre-Depends}\n"]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    split = (line.partition("\t") for line in lines)
    return {name: re.findall(r"(?:^|[,|]) *([a-z0-9.+-]+)", depends) for name, _, depends in split}


def with_dependencies(package: str) -> set[str]:
    """A package and all that it depends on."""
    found: set[str] = set()
    queue = [package]
    while queue:
        name = queue.pop()
        if name not in found:
            found.add(name)
            queue += depends_on().get(name, [])
    return found


# Part of every Debian that runs a program of C++ linked with any of the others.
_ALWAYS = {"libc6", "libgcc-s1"}


@pytest.mark.parametrize("image", ["worker", "api"])
def test_images_have_the_libraries_of_their_programs(image: str) -> None:
    listed = packages(image)
    has = _ALWAYS | {each for package in listed for each in with_dependencies(package)}
    for name in sorted(copied_from_programs(image)):
        missing = needed_packages(PROGRAMS / name) - has
        assert missing == set(), f"{name} in the image {image}"


def test_what_is_copied_is_there_and_not_ignored() -> None:
    rules = (ROOT / ".dockerignore").read_text().splitlines()
    let_in = {rule.removeprefix("!") for rule in rules if rule.startswith("!")}
    for stage, lines in STAGES.items():
        for line in lines:
            if not line.startswith("COPY ") or "--from=" in line:
                continue
            for source in line.split()[1:-1]:
                assert (ROOT / source).exists(), f"{stage}: {line}"
                assert any(source == name or source.startswith(f"{name}/") for name in let_in), line


def test_what_is_copied_between_stages_is_of_an_earlier_one() -> None:
    names = list(STAGES)
    for index, stage in enumerate(names):
        for source in re.findall(r"--from=(\S+)", "\n".join(STAGES[stage])):
            assert source in names[:index], f"{stage} takes from {source}"


_ENTRIES = {
    "redis": ["with-secrets", "/opt/redis/start.sh"],
    "tunnel": ["/opt/stunnel/start.sh"],
    "worker": ["with-secrets", "nocturne-worker"],
    "coordinator": ["with-secrets", "nocturne-coordinator"],
    "api": ["with-secrets", "nocturne-api"],
}


@pytest.mark.parametrize("image", _ENTRIES)
def test_images_run_without_root(image: str) -> None:
    users = [line for line in lineage(image) if line.startswith("USER ")]
    assert users[-1] == "USER 10001:10001"
    entry = [line for line in lineage(image) if line.startswith("ENTRYPOINT ")]
    assert json.loads(entry[-1].removeprefix("ENTRYPOINT ")) == _ENTRIES[image]


def compose() -> dict[str, Any]:
    """The compose file."""
    found: dict[str, Any] = yaml.safe_load((ROOT / "docker-compose.yml").read_text())
    return found


def version() -> str:
    """The project's."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    return str(project["version"])


def test_compose_builds_images_that_there_are() -> None:
    for name, service in compose()["services"].items():
        if "build" in service:
            target = service["build"]["target"]
            assert target in STAGES, name
            assert service["image"] == f"nocturne-{target}:{version()}", name
            assert (ROOT / service["build"]["dockerfile"]).is_file()


def test_images_of_others_are_pinned_by_digest() -> None:
    pinned = re.compile(r"[\w./-]+:[\w.-]+@sha256:[0-9a-f]{64}")
    for name, service in compose()["services"].items():
        assert "build" in service or pinned.fullmatch(service["image"]), name
    dockerfile = (ROOT / "deploy" / "Dockerfile").read_text()
    (base,) = re.findall(r"^ARG DEBIAN=(\S+)$", dockerfile, re.MULTILINE)
    assert pinned.fullmatch(base)
    arguments = [service["build"]["args"] for service in compose()["services"].values() if "build" in service]
    assert all(each == {"DEBIAN": f"${{NOCTURNE_DEBIAN:-{base}}}"} for each in arguments)
    assert set(re.findall(r"^FROM (\S+)", dockerfile, re.MULTILINE)) - set(STAGES) == {"${DEBIAN}"}


def test_containers_of_compose_are_contained() -> None:
    for name, service in compose()["services"].items():
        assert service["read_only"] is True, name
        assert service["cap_drop"] == ["ALL"], name
        assert service["security_opt"] == ["no-new-privileges:true"], name
        # A worker may use all processors by default, with the smallest share of them.
        assert {"mem_limit", "cpus", "pids_limit"} <= service.keys(), name


def _mounts() -> dict[str, set[str]]:
    """By named volume: the services that mount it."""
    found: dict[str, set[str]] = {}
    for name, service in compose()["services"].items():
        for volume in service.get("volumes", ()):
            found.setdefault(volume.split(":")[0], set()).add(name)
    return found


def test_secrets_are_seen_by_their_role_only() -> None:
    mounts = _mounts()
    assert mounts["redis-coordinator"] == {"passwords", "redis", "coordinator"}
    assert mounts["token-worker"] == {"tokens", "worker"}
    assert mounts["token-admin"] == {"tokens", "api"}
    assert mounts["token-read"] == {"tokens", "prometheus"}
    for name, service in compose()["services"].items():
        for variable, value in (service.get("environment") or {}).items():
            is_secret = re.search("PASSWORD|TOKEN|SECRET", variable)
            assert not is_secret or variable.endswith("_FILE"), f"{name}: {variable}={value}"


def test_a_worker_meets_redis_and_the_api_only() -> None:
    services, networks = compose()["services"], compose()["networks"]
    reaches = set()
    for network in services["worker"]["networks"]:
        assert networks[network] == {"internal": True}
        reaches |= {name for name, service in services.items() if network in service.get("networks", ())}
    assert reaches == {"worker", "redis", "coordinator", "api"}
    assert "coordinator" not in {
        name for name, service in services.items() if "assets" in service.get("networks", ())
    }
    assert "--auth" in services["api"]["command"]
    # The coordinator listens nowhere.
    assert "ports" not in services["coordinator"]
    # Each its own: what one worker writes, no other reads.
    assert "/cache" in services["worker"]["volumes"]
