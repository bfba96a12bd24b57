"""`nocturne-coordinator --data DIR --redis URL`: the coordinator as a process."""

import argparse
import logging
import math
import secrets
import signal
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path

from nocturne_scene.errors import NocturneError

from nocturne_coordinator.clock import Clock
from nocturne_coordinator.coordinator import Coordinator
from nocturne_coordinator.dispatch.audit import NEW_SHARE, SHARE
from nocturne_coordinator.dispatch.job_cost import JOB_SECONDS
from nocturne_coordinator.dispatch.scheduler import MIN_OVERDUE
from nocturne_coordinator.dispatch.state import COMMIT_SECONDS, Settings
from nocturne_coordinator.errors import AlreadyOwned, OwnershipLost, QueueError, QueueInUse, UnusableFolder
from nocturne_coordinator.event_log import EventLog
from nocturne_coordinator.heartbeat import Heartbeat
from nocturne_coordinator.log_lines import write_log_lines
from nocturne_coordinator.memory import memory_bytes
from nocturne_coordinator.output.previews import Previews
from nocturne_coordinator.queue.guard import Guard
from nocturne_coordinator.queue.job_queue import JobQueue, Session
from nocturne_coordinator.signals import on_signals
from nocturne_coordinator.store.checkpoint import CHECKPOINT_SECONDS, Checkpointer
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.database import DatabaseTrouble
from nocturne_coordinator.store.databases import server_of
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import LEASE_SECONDS, Ownership
from nocturne_coordinator.traces import start_traces

EXIT_UNUSABLE = 2
EXIT_ALREADY_OWNED = 3
EXIT_OWNERSHIP_LOST = 4

_log = logging.getLogger("nocturne_coordinator")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs until SIGTERM or SIGINT; gives the exit code. SIGHUP has it look at the data folder at once."""
    options = _parser().parse_args(arguments)
    write_log_lines(options.log_level, "coordinator")
    stop = threading.Event()
    on_signals({signal.SIGTERM: stop.set, signal.SIGINT: stop.set})
    # Until it works there is nothing to look at.
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        _run(options, stop)
    except (AlreadyOwned, QueueInUse) as error:
        _log.error("%s", error)
        return EXIT_ALREADY_OWNED
    except OwnershipLost as error:
        _log.error("%s", error)
        return EXIT_OWNERSHIP_LOST
    except (NocturneError, ValueError) as error:
        _log.error("%s", error)
        return EXIT_UNUSABLE
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="nocturne-coordinator",
        description="Cuts renders into jobs, merges their results, keeps the data folder.",
        epilog=f"Exit code {EXIT_ALREADY_OWNED}: the data folder, or Redis, has a coordinator already.",
    )
    parser.add_argument("--data", type=Path, required=True, help="data folder; made if it isn't there")
    parser.add_argument(
        "--redis",
        required=True,
        help="redis://host:port, unix:///path/to/socket, or for TLS "
        "rediss://host:port?ssl_ca_certs=PEM&ssl_certfile=PEM&ssl_keyfile=PEM; user and "
        "password come from the environment: NOCTURNE_REDIS_USER, NOCTURNE_REDIS_PASSWORD",
    )
    parser.add_argument(
        "--enrolled",
        action="store_true",
        help="only workers that enrolled count (nocturne-worker --enrol): each machine gets a user of Redis, "
        "and signs its results",
    )
    _add_audit_options(parser.add_argument_group("failure policy and audits"))
    _add_commit_options(parser.add_argument_group("commits and checkpoints"))
    _add_sharing_options(parser.add_argument_group("several coordinators on one folder"))
    _add_monitoring_options(parser.add_argument_group("monitoring"))
    return parser


def _add_audit_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--overdue-seconds",
        type=_seconds,
        default=MIN_OVERDUE,
        help="a job without a result is published again after that, or 20 times the usual time if that is "
        "longer (default %(default)s)",
    )
    group.add_argument(
        "--job-seconds",
        type=_seconds,
        default=JOB_SECONDS,
        help="processor time that a job should take at most; ranges are cut by what earlier ones took, and a "
        "job is stopped at ten times that (default %(default)s)",
    )
    group.add_argument(
        "--audit-share",
        type=_share,
        default=SHARE,
        help="part of all jobs that is traced again by another worker (default %(default)s)",
    )
    group.add_argument(
        "--audit-share-new",
        type=_share,
        default=NEW_SHARE,
        help="the same of the first jobs of a worker (default %(default)s)",
    )


def _add_commit_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--commit-seconds",
        type=float,
        default=COMMIT_SECONDS,
        help="time between commits: what a crash may cost (default %(default)s)",
    )
    group.add_argument(
        "--checkpoints",
        type=Path,
        metavar="DIR",
        help="where copies of the database go, best on another disk (default: DATA/checkpoints)",
    )
    group.add_argument(
        "--checkpoint-seconds",
        type=float,
        default=CHECKPOINT_SECONDS,
        help="time between two (default %(default)s); 0: none",
    )


def _add_sharing_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--shared",
        action="store_true",
        help="share the folder's renders with other coordinators that are started so",
    )
    group.add_argument(
        "--lease-seconds",
        type=float,
        default=LEASE_SECONDS,
        help="with --shared, after how long without a sign of life others take renders (default %(default)s)",
    )


def _add_monitoring_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--event-log",
        type=Path,
        metavar="FILE",
        help="write down all that decides, at most 1 GiB, for `python -m nocturne_coordinator.replay FILE`; "
        "the last one is kept as FILE.1",
    )
    group.add_argument(
        "--alive",
        type=Path,
        metavar="FILE",
        help="its time is set about every second while the coordinator works on the folder: for probes",
    )
    group.add_argument("--log-level", default="info", choices=["debug", "info", "warning", "error"])


def _share(text: str) -> float:
    share = float(text)
    if not 0.0 <= share <= 1.0:
        raise argparse.ArgumentTypeError("expected 0 to 1")
    return share


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0.0 < seconds < math.inf:
        raise argparse.ArgumentTypeError("expected more than 0")
    return seconds


def _run(options: argparse.Namespace, stop: threading.Event) -> None:
    data: Path = options.data
    traces = start_traces("coordinator")
    folder, ownership = _open(data, options.shared, options.lease_seconds)
    queue = JobQueue(options.redis)
    if options.enrolled:
        queue.guard = Guard(folder.machines.lease_key(), folder.machines.keys())
    session = Session(ownership.folder, ownership.epoch, secrets.token_hex(8), options.shared)
    event_log: EventLog | None = None
    previews: Previews | None = None
    try:
        _check_queue(queue, stop)
        _take_lease(queue, session, stop)
        _log.info(
            "number %d works on %s, epoch %d, process started %.0f",
            *(ownership.number, data, ownership.epoch, time.time()),
        )
        settings = Settings(
            ownership.number,
            options.commit_seconds,
            options.overdue_seconds,
            options.audit_share,
            options.audit_share_new,
            options.job_seconds,
            options.enrolled,
            memory_bytes(),
        )
        ledger = Ledger(folder.database, ownership)
        if server_of(data):
            _log.info("the database is on a server, which makes its own backups: no checkpoints")
        elif options.checkpoint_seconds > 0.0:
            place = options.checkpoints or data / "checkpoints"
            checkpointer = Checkpointer(data, place, options.checkpoint_seconds)
            threading.Thread(target=checkpointer.run, args=(stop,), daemon=True).start()
        if options.event_log:
            event_log = _open_event_log(options.event_log, settings, ledger)
        alive = Heartbeat(options.alive)
        previews = Previews(folder, ledger, alive)
        clock = Clock(stop)
        coordinator = Coordinator(
            folder, ledger, previews, queue, session, settings, clock, event_log, traces
        )
        signal.signal(signal.SIGHUP, lambda *_: coordinator.look_again())
        coordinator.run(alive)
    finally:
        if event_log is not None:
            event_log.close()
        if previews is not None:
            previews.close()
        queue.close()
        ownership.release()
        folder.close()
        traces.close()


def _open(data: Path, shared: bool, lease_seconds: float) -> tuple[DataFolder, Ownership]:
    folder = DataFolder(data)
    try:
        return folder, Ownership(data, folder.database, shared, lease_seconds)
    except (OSError, DatabaseTrouble) as trouble:
        folder.close()
        raise UnusableFolder.because(data, trouble) from trouble


def _open_event_log(path: Path, settings: Settings, ledger: Ledger) -> EventLog:
    try:
        return EventLog(path, settings, ledger.workers.quarantined())
    except OSError as trouble:
        raise UnusableFolder.because(path.parent, trouble) from trouble


def _take_lease(queue: JobQueue, session: Session, stop: threading.Event) -> None:
    """Waits until a lease left by another data folder's coordinator ends; QueueInUse if it is renewed."""
    left_before = 0
    while not stop.is_set():
        try:
            queue.check_lease(session)
        except QueueInUse:
            left = queue.lease_left()
            if 0 < left_before < left:
                raise
            left_before = left
            stop.wait(0.3)
        except QueueError:
            # Redis is down or comes late: the coordinator works without it, and asks again.
            return
        else:
            return


def _check_queue(queue: JobQueue, stop: threading.Event) -> None:
    """Waits for Redis and checks how it is set up; a Redis that will not tell is taken as it is."""
    wait = 0.1
    while not stop.is_set():
        try:
            queue.check_settings()
        except QueueError as trouble:
            if "NoPermission" in str(trouble):
                return
            _log.warning("waits for Redis: %s", trouble)
            stop.wait(wait)
            wait = min(2 * wait, 2.0)
        else:
            return


if __name__ == "__main__":
    sys.exit(main())
