"""Prometheus, Grafana and the compose file speak of metrics and files that there are."""

import json
import re
from pathlib import Path

import yaml
from nocturne_api.background.space import DiskQuota
from nocturne_api.operations.health import metrics_text
from nocturne_coordinator.store.data_folder import DataFolder

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"
KUBERNETES = DEPLOY / "kubernetes"


def metric_names(tmp_path: Path) -> set[str]:
    folder = DataFolder(tmp_path / "data")
    space = DiskQuota(folder.root, 0.0).figures()
    try:
        return set(re.findall(r"^(nocturne_\w+)", metrics_text(folder, space).decode(), re.MULTILINE))
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
    assert scales == {"nocturne_open_cpu_seconds"}
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
