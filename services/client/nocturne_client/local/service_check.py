"""`nocturne doctor --url`: whether a service can be used from here, and whether it can render."""

import time
from collections.abc import Iterator
from email.utils import parsedate_to_datetime

from nocturne_client.client import Client
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.doctor import Finding
from nocturne_client.models import Worker

_CLOCK_S = 5.0
"""Apart from which times of stop conditions and of the list mislead."""


def examine_service(url: str | None) -> list[Finding]:
    """Looks at one service; questions that can't be asked any more are left out."""
    with Client(url) as client:
        found: list[Finding] = []
        try:
            found.extend(_answers(client))
            found.extend(_workers([*client.workers()]))
        except NocturneClientError as error:
            advice = "check the address, the network and the token (NOCTURNE_TOKEN)"
            found.append(Finding(f"service at {client.url}", False, str(error), advice))
        return found


def _answers(client: Client) -> Iterator[Finding]:
    session, date = client.session()
    who = f"as {session.name}" if session.name else "without a token, as nobody needs one"
    yield Finding(f"service at {client.url}", True, f"answers {who}")
    may = "submit" in session.scopes
    yield Finding("may submit", may, ", ".join(session.scopes), "ask for a token with `submit`", needed=False)
    ready = client.is_ready()
    advice = "its log says why: the database, or no coordinator"
    yield Finding("ready", ready, "yes" if ready else "no", advice)
    if date:
        apart = abs(parsedate_to_datetime(date).timestamp() - time.time())
        advice = "set both clocks (NTP): times of --until are those of the service"
        yield Finding("clocks", apart < _CLOCK_S, f"{apart:.0f} s apart", advice, needed=False)


def _workers(workers: list[Worker]) -> Iterator[Finding]:
    able = [each for each in workers if not each.quarantine and not each.incompatible]
    found = f"{len(able)} with {sum(each.threads for each in able)} threads"
    kept = next((each.quarantine or each.incompatible for each in workers if each not in able), "")
    told = f"{found}; {len(workers) - len(able)} get no jobs: {kept}" if kept else found
    yield Finding("workers", bool(able), told, "start `nocturne-worker`, or `nocturne workers --release`")
