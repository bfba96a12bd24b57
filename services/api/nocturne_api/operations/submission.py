"""Checks what callers send, so that all problems are reported at once, and compiles scenes. Synchronous."""

import json
import re
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any, TypeVar

from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions, stop_conditions
from nocturne_coordinator.limits import DEFAULT_PRIORITY, MAX_NAME, MAX_REQUEST_ID
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.renders import check_priority
from nocturne_coordinator.store.rows import NewRender
from nocturne_coordinator.store.tags import checked_tags
from nocturne_scene.compile.layers import check_can_make, usual_layers
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.read import check_document
from nocturne_scene.document.sensors import Meters, film_size
from nocturne_scene.errors import InputError, Problem
from nocturne_scene.film import Film
from nocturne_scene.layers import known_layers
from nocturne_scene.ranges import make_schedule
from nocturne_scene.scene_ranges import schedule_for_scene

from nocturne_api.compiling.pool import CompileLimits, compile_in_child
from nocturne_api.models.render_requests import CreateRenderRequest
from nocturne_api.operations.group_members import Member

_T = TypeVar("_T")
_SHA256 = re.compile("[0-9a-f]{64}")


def compiled_member(
    asked: CreateRenderRequest,
    member: Member,
    folder: DataFolder,
    owner: str,
    compile_limits: CompileLimits,
    abandoned: threading.Event,
) -> NewRender:
    """A member of a group; as `compiled`, with problems that name the member."""
    try:
        return compiled(member.request(asked), folder, owner, compile_limits, abandoned)
    except InputError as error:
        raise member.located(error) from None


def compiled(
    request: CreateRenderRequest,
    folder: DataFolder,
    owner: str,
    compile_limits: CompileLimits,
    abandoned: threading.Event | None = None,
) -> NewRender:
    """The render that `request` asks for, its scene compiled into the folder's blobs.

    Raises InputError with all problems, and then leaves nothing behind; Abandoned when that event is set. Can
    take seconds of processor time.
    """
    found = _Problems()
    found.add(_text_problems(request))
    film = (request.width, request.height, request.samples)
    schedule = found.collect(lambda: make_schedule(*film))
    document = found.collect(lambda: check_document(request.scene))
    # A request id used before decides without the scene, so a conflict leaves no blobs behind.
    before = folder.renders.find_request(owner, request.request_id) if not found.problems else None
    stop = found.collect(lambda: checked_stop(request.stop, before.stop if before else EVERYTHING))
    priority = request.priority or DEFAULT_PRIORITY
    found.collect(lambda: check_priority(priority))
    layers = found.collect(lambda: known_layers(request.layers))
    tags = found.collect(lambda: checked_tags(request.tags))
    if (
        found.problems
        or schedule is None
        or document is None
        or stop is None
        or layers is None
        or tags is None
    ):
        raise InputError(found.problems)
    width, height = film_size(document.sensor, request.width, request.height)
    new = NewRender(
        request_id=request.request_id,
        name=request.name,
        scene_sha256="",
        scene_document=_canonical(request.scene),
        width=width,
        height=height,
        samples=request.samples,
        schedule=schedule,
        stop=stop,
        priority=priority,
        owner=owner,
        sensor=_sensor_of(document),
        layers=layers,
        usual_layers=usual_layers(document, Film(width, height, request.samples)),
        in_group=request.group,
        after_group=request.after,
        tags=tags,
    )
    if before is None:
        return _with_scene(new, document, folder, compile_limits, abandoned)
    schedule, sha256 = folder.renders.schedule(before.id), before.scene_sha256
    same = replace(new, scene_sha256=sha256, schedule=schedule, warnings=before.warnings, way=before.way)
    return _planned(same)


def _sensor_of(document: SceneDocument) -> str:
    """Its type; of meters that measure daylight coefficients "daylight"."""
    sensor = document.sensor
    return "daylight" if isinstance(sensor, Meters) and sensor.daylight is not None else sensor.type


def _with_scene(
    new: NewRender,
    document: SceneDocument,
    folder: DataFolder,
    compile_limits: CompileLimits,
    abandoned: threading.Event | None,
) -> NewRender:
    check_can_make(new.layers)
    film = new.width, new.height, new.samples
    output = compile_in_child(document, folder.blobs, compile_limits, Film(*film), abandoned)
    for sha256 in output.blobs:
        # Here too, not in the object store only.
        folder.blobs.path(sha256)
    made = replace(
        new,
        scene_sha256=output.scene_sha256,
        schedule=schedule_for_scene(folder.blobs, output.scene_sha256, *film),
        warnings=tuple(output.warnings),
        way=output.way,
        files=output.blobs,
    )
    return _planned(made)


def _planned(new: NewRender) -> NewRender:
    """Of the Sun's disc one sample is taken, however many are asked for."""
    once = new.schedule.coefficients and list(new.schedule.range_ends) == [1]
    return replace(new, samples=1) if once else new


def checked_stop(asked: Mapping[str, Any], before: StopConditions) -> StopConditions:
    """What a caller asks for; a time in the same words as `before` is the same time. Raises InputError."""
    if before.until_text and asked.get("until") == before.until_text:
        others = {name: value for name, value in asked.items() if name != "until"}
        stop = stop_conditions(others, datetime.now(UTC))
        return replace(stop, until=before.until, until_text=before.until_text)
    return stop_conditions(asked, datetime.now(UTC))


def _text_problems(request: CreateRenderRequest) -> Iterator[Problem]:
    yield from request_id_problems(request.request_id)
    for field_name in ("name", "group", "after"):
        yield from _name_problems(getattr(request, field_name), f"$.{field_name}")
    if request.group and request.group == request.after:
        yield Problem("$.after", "is the render's own group, which would never begin")


def request_id_problems(request_id: str) -> Iterator[Problem]:
    if not 0 < len(request_id) <= MAX_REQUEST_ID or not request_id.isprintable():
        message = f"expected 1 to {MAX_REQUEST_ID} printable characters, different for every request"
        yield Problem("$.request_id", message)


def _name_problems(name: str, place: str) -> Iterator[Problem]:
    if len(name) > MAX_NAME or not name.isprintable():
        yield Problem(place, f"expected at most {MAX_NAME} printable characters")


def digest_problems(digest: str, place: str) -> Iterator[Problem]:
    if not _SHA256.fullmatch(digest):
        yield Problem(place, "expected a SHA-256 digest: 64 lower-case hexadecimal digits")


def raise_if(problems: Iterable[Problem]) -> None:
    found = list(problems)
    if found:
        raise InputError(found)


class _Problems:
    """Problems found so far in one request."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []

    def add(self, problems: Iterable[Problem]) -> None:
        self.problems += problems

    def collect(self, make: Callable[[], _T]) -> _T | None:
        """What `make` gives, or None and the problems of its InputError noted."""
        try:
            return make()
        except InputError as error:
            self.add(error.problems)
            return None


def _canonical(scene: Any) -> str:
    """The document in one spelling, so that a repeated request is known by either transport."""
    return json.dumps(scene, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
