"""A night among strangers: Redis behind a tunnel with a user for each role, TLS and tokens everywhere."""

import ssl
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import trustme
from nocturne_client.local.programs import need_program

from tests.system.guarded_service import GuardedService
from tests.system.images import Image, differing_values
from tests.system.renders import BRIEF_SAMPLES, finished_image, submit
from tests.system.tunnel import authority_file, needs_stunnel
from tests.system.waiting import wait_for

pytestmark = [pytest.mark.system, needs_stunnel]


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[GuardedService]:
    running = GuardedService(tmp_path_factory.mktemp("g"))
    yield running
    running.close()


def test_the_image_is_that_of_a_run_alone(service: GuardedService, traced_alone_briefly: Image) -> None:
    render_id = submit(service.client, BRIEF_SAMPLES)
    # Who has no token, the wrong one, or another authority gets no scene, and says so.
    others = authority_file(trustme.CA(), service.folder, "others.pem")
    strangers = {
        "not known, or was revoked": service.start_worker("stranger", "nct_wrong", service.trusted),
        "a token is needed": service.start_worker("nobody", "", service.trusted),
        "(gRPC status 14)": service.start_worker("deceived", service.tokens["worker"], others),
    }
    for words, stranger in strangers.items():
        wait_for(lambda stranger=stranger, words=words: words in stranger.tail(), words)  # type: ignore[misc]
        assert "loaded" not in stranger.tail()
        stranger.kill()
    assert service.client.get(render_id).progress.ranges_done == 0
    worker = service.start_worker("enrolled", service.tokens["worker"], service.trusted)
    image = finished_image(service.client, render_id, BRIEF_SAMPLES)
    assert differing_values(image, traced_alone_briefly) == {}
    # Redis may not know the machine for the first second.
    assert [
        line for line in worker.tail().splitlines() if "WARNING" in line and "WRONGPASS" not in line
    ] == []
    assert worker.end() == 0


def test_the_endpoints_speak_tls_to_those_with_tokens_only(service: GuardedService) -> None:
    with pytest.raises(httpx.ConnectError):
        httpx.get(f"{service.url}/v1/renders", trust_env=False)
    with pytest.raises(httpx.TransportError):
        httpx.get(f"http://127.0.0.1:{service.port}/v1/renders", trust_env=False)
    trusting = ssl.create_default_context(cafile=service.trusted)
    answer = httpx.get(f"{service.url}/v1/renders", verify=trusting, trust_env=False)
    assert answer.status_code == 401


def test_a_worker_that_can_not_enrol_ends_when_it_is_told(service: GuardedService) -> None:
    waiting = service.start_worker("waiting", "nct_wrong", service.trusted)
    wait_for(lambda: "can't enrol" in waiting.tail(), "the worker to wait")
    began = time.monotonic()
    assert waiting.end() == 0
    assert time.monotonic() - began < 3.0


def test_an_authority_that_is_none_is_named(tmp_path: Path) -> None:
    (tmp_path / "no.pem").write_text("no certificate")
    said = subprocess.run(
        [
            *(need_program("nocturne-worker"), "--redis", "tcp://127.0.0.1:1", "--assets", "localhost:1"),
            *("--cache", tmp_path, "--assets-ca", tmp_path / "no.pem"),
        ],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert said.returncode == 1
    assert "no.pem: has no certificate in PEM" in said.stderr
