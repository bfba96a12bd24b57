"""The client: every operation of the service as one method.

One file, though long: a list of short methods, each a call.
"""

import json
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import IO, TYPE_CHECKING, Any, Literal
from urllib.parse import quote

import httpx
from httpx_sse import EventSource

from nocturne_client.contract import (
    Explanation,
    Glare,
    Group,
    ImportedScene,
    Isolines,
    MeasuredRegions,
    Measurements,
    NewWebhook,
    Outline,
    PreflightReport,
    Reading,
    Region,
    Session,
    Usage,
    Webhook,
    Worker,
    WorkOfWorker,
)
from nocturne_client.decoding import decode
from nocturne_client.errors import NocturneClientError
from nocturne_client.import_files import files_of_import
from nocturne_client.models import Render
from nocturne_client.outputs import check_output, written
from nocturne_client.scene_files import SceneOnDisk, digest, read_scene
from nocturne_client.transport import PATIENCE_S, RETRY_DELAYS_S, OnWait, Transport

if TYPE_CHECKING:
    from nocturne_client.tiles import TileAnswer

ImageKind = Literal["exr", "png", "scene", "denoised_exr", "denoised_png", "difference", "log", "bundle"]
UploadProgress = Callable[[Path, int, int], None]

_PATHS: dict[ImageKind, str] = {
    "exr": "image.exr",
    "png": "preview.png",
    "scene": "scene.json",
    "denoised_exr": "denoised.exr",
    "denoised_png": "denoised.png",
    "difference": "difference.png",
    "log": "log.txt",
    "bundle": "bundle.zip",
}
# The service sends a comment every 15 s, so a longer silence is a lost connection.
_WATCH_TIMEOUT = httpx.Timeout(40.0, connect=5.0)
# A service that is started again is there within seconds; one whose machine is, within minutes.
_WATCH_DELAYS_S = (*RETRY_DELAYS_S, *([2.0] * 10), *([5.0] * 60))
# A preflight's small renders; the service ends it before that.
_PREFLIGHT_TIMEOUT = httpx.Timeout(1000.0, connect=5.0)
# All scenes of a group are compiled before the answer.
_GROUP_TIMEOUT = httpx.Timeout(7200.0, connect=5.0)
_PIECE_BYTES = 1024 * 1024


class Client:
    """One service. Use it as a context manager, or `close` it. Raises NocturneClientError only.

    `url` defaults to the environment variable NOCTURNE_URL, else http://127.0.0.1:7070. Calls are tried again
    only when the service was not reached or said that it is busy; all of them are safe to repeat.
    """

    def __init__(
        self,
        url: str | None = None,
        transport: httpx.BaseTransport | None = None,
        token: str | None = None,
        patience_s: float = PATIENCE_S,
        on_wait: OnWait | None = None,
    ) -> None:
        """`token` defaults to the environment variable NOCTURNE_TOKEN; none is sent where there is none.

        A service that is busy, or has a quota used up, says after how many seconds to ask again: a call waits
        so, for `patience_s` in all, and tells `on_wait`. The PEM file NOCTURNE_CA, where it is set, says
        whose certificates are believed.
        """
        self._transport = Transport(url, transport, token, patience_s, on_wait)
        self.url = self._transport.url

    def __enter__(self) -> "Client":
        return self

    def __exit__(
        self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Lets go of the connections."""
        self._transport.close()

    def upload(self, path: Path, sha256: str | None = None, progress: UploadProgress | None = None) -> str:
        """Stores a file and gives its SHA-256; `progress` gets path, bytes sent and size."""
        sha256 = sha256 or digest(path)
        size = path.stat().st_size

        def send() -> None:
            headers = {"Content-Length": str(size), "Content-Type": "application/octet-stream"}
            self._transport.send(
                "PUT", f"/v1/assets/{sha256}", content=_pieces(path, progress), headers=headers
            )

        self._transport.retrying(send)
        return sha256

    def submit(
        self,
        scene: Path | Mapping[str, Any],
        width: int,
        height: int,
        samples: int,
        name: str = "",
        request_id: str | None = None,
        progress: UploadProgress | None = None,
        stop: Mapping[str, Any] | None = None,
        priority: int = 0,
        layers: Sequence[str] = (),
        changes: Mapping[str, Any] | None = None,
        group: str = "",
        after: str = "",
        tags: Sequence[str] = (),
    ) -> Render:
        """Uploads what the scene document at `scene` names and the service lacks, and starts a render.

        `scene` may be a document itself, as imports give it: the service has its files.
        Film in pixels, at most `samples` per pixel. `name`: else the document's own, else the file's.
        `stop`: what else ends it, whichever comes first, of
        relative_error, tile_relative_error, wall_seconds, cpu_seconds, until ("07:00 Europe/Berlin").
        `changes` of the document: values by their places, such as `sensor.position[0]`.
        `layers`: further channels of the EXR, of albedo, normal, depth, position, object, material,
        emission.
        Renders with the same `group` are one; `after`: a group that has to end before this render begins.
        `tags`: words to sort renders by. Submitting again with the same `request_id` gives the same render.
        """
        settings: dict[str, Any] = {
            "stop": dict(stop or {}),
            "changes": dict(changes or {}),
            "layers": [*layers],
        }
        settings |= {"priority": priority, "group": group, "after": after, "tags": [*tags]}
        return self.submit_group(scene, width, height, samples, name, request_id, progress, **settings)[0]

    def submit_group(
        self,
        scene: Path | SceneOnDisk | Mapping[str, Any],
        width: int,
        height: int,
        samples: int,
        name: str = "",
        request_id: str | None = None,
        progress: UploadProgress | None = None,
        varied: Sequence[tuple[str, Sequence[Any]]] = (),
        frames: tuple[int, int] | None = None,
        member: str = "",
        **settings: Any,
    ) -> Sequence[Render]:
        """A render in every combination of `varied`, places and their values, and in every frame from the
        first to the last; all of them or none. All else, `settings` too, is as in `submit`.

        In frames a change to a text such as `-1..1` goes evenly from the first frame to the last. `member`:
        what tells the scene from others of its group, comes after the name.
        """
        document = scene
        if isinstance(scene, Path | SceneOnDisk):
            on_disk = scene if isinstance(scene, SceneOnDisk) else read_scene(scene)
            self._send(on_disk.files, progress)
            document, name = on_disk.document, name or on_disk.name or ("" if member else _stem(scene))
        body = {
            "request_id": request_id or str(uuid.uuid4()),
            "name": f"{name} {member}".strip(),
            "scene": document,
            "width": width,
            "height": height,
            "samples": samples,
            "varied": [{"place": place, "values": values} for place, values in varied],
            "frames": frames and dict(zip(("first", "last"), frames, strict=True)),
            **settings,
        }
        call = partial(self._transport.send_json, "POST", "/v1/groups", body, timeout=_GROUP_TIMEOUT)
        return [decode(Render, each) for each in self._transport.retrying(call)["renders"]]

    def import_scene(
        self,
        scene: Path,
        allow_missing: bool = False,
        light: str = "",
        progress: UploadProgress | None = None,
    ) -> ImportedScene:
        """Makes a scene document of another renderer's scene, whose files the service keeps; takes up to
        minutes.

        A .glb or .zip file is a scene by itself; of others all files below their folder are uploaded.
        `light`: `sky`, `studio` or the path of a picture in that folder.
        """
        files = files_of_import(scene)
        self._send(dict(files.values()), progress)
        body = {
            "files": {name: sha256 for name, (sha256, _) in files.items()},
            "scene": scene.name,
            "allow_missing": allow_missing,
            "light": light,
        }
        # Not repeated: a second one would take minutes again.
        answer = self._transport.send_json("POST", "/v1/imports", body, timeout=_PREFLIGHT_TIMEOUT)
        return decode(ImportedScene, answer)

    def preflight(
        self, scene: Path, width: int, height: int, error: float = 0.02, budget_seconds: float = 60.0
    ) -> PreflightReport:
        """What the scene document at `scene` needs for a total relative error; takes minutes.

        `budget_seconds`: processor time of the service's small renders.
        """
        on_disk = self._uploaded(scene, None)
        asked = {"error": error, "budget_seconds": budget_seconds}
        body = {"scene": on_disk.document, "width": width, "height": height, **asked}
        # Not repeated: a second one would take minutes again.
        answer = self._transport.send_json("POST", "/v1/preflights", body, timeout=_PREFLIGHT_TIMEOUT)
        return decode(PreflightReport, answer)

    def get(self, render_id: str) -> Render:
        """One render."""
        return decode(Render, self._transport.get(f"/v1/renders/{_part(render_id)}"))

    def cancel(self, render_id: str, request_id: str | None = None) -> Render:
        """Stops a render; its merged samples stay."""
        return self._act(render_id, "cancel", {"request_id": request_id or str(uuid.uuid4())})

    def delete(self, render_id: str) -> None:
        """Forgets a render that has ended, with its images and the files that no other render uses."""
        # Not repeated: the second time there is no such render.
        self._transport.send("DELETE", f"/v1/renders/{_part(render_id)}")

    def pause(self, render_id: str) -> Render:
        """No more work on a render until it is resumed."""
        return self._act(render_id, "pause", {})

    def resume(self, render_id: str) -> Render:
        """Goes on with a paused render; with a degraded one, by tracing its failed tiles again."""
        return self._act(render_id, "resume", {})

    def extend(
        self,
        render_id: str,
        samples: int = 0,
        stop: Mapping[str, Any] | None = None,
        drop: Sequence[str] = (),
    ) -> Render:
        """More samples per pixel, 0 for as many as before, and conditions that change; all others stay.

        `drop`: names of conditions to go on without.
        """
        return self._act(render_id, "extend", {"samples": samples, "stop": dict(stop or {}), "drop": [*drop]})

    def set_priority(self, render_id: str, priority: int) -> Render:
        """The render's weight among those of its owner, 1 to 1000."""
        return self._act(render_id, "setPriority", {"priority": priority})

    def set_tags(self, render_id: str, tags: Sequence[str]) -> Render:
        """Words to sort renders by, instead of those that it has."""
        return self._act(render_id, "setTags", {"tags": [*tags]})

    def replay(self, render_id: str, request_id: str | None = None) -> Render:
        """A new render with the samples per tile that this one has: its image has the same bits."""
        return self._act(render_id, "replay", {"request_id": request_id or str(uuid.uuid4())})

    def baselines(self, render_id: str) -> Sequence[Render]:
        """Renders of the same scene and film by other engines, the newest of each."""
        answer = self._transport.get(f"/v1/renders/{_part(render_id)}/baselines")
        return [decode(Render, each) for each in answer["renders"]]

    def explain(self, render_id: str) -> str:
        """What the render waits for, in one sentence."""
        answer = self._transport.get(f"/v1/renders/{_part(render_id)}/explanation")
        return decode(Explanation, answer).sentence

    def read_region(self, render_id: str, region: Region | None = None) -> Reading:
        """What a region of the image shows, or the whole image, in numbers, with their errors."""
        params = None if region is None else asdict(region)
        answer = self._transport.get(f"/v1/renders/{_part(render_id)}/reading", params)
        return decode(Reading, answer)

    def measure(
        self,
        render_id: str,
        outlines: Sequence[Outline] = (),
        channel: str = "Y",
        bins: int = 0,
        bounds: tuple[float, float] = (0.0, 0.0),
        logarithmic: bool = False,
        colour: bool = False,
    ) -> Measurements:
        """Extremes, mean and uniformity of parts of the image, with their errors.

        Without outlines of those kept with the render; where there are none, of the whole film. `bins`: of a
        histogram, between `bounds` or as the values are. `colour`: with that of the light, where it is known.
        """
        body = {
            "outlines": [asdict(outline) for outline in outlines],
            "channel": channel,
            "bins": bins,
            "low": bounds[0],
            "high": bounds[1],
            "logarithmic": logarithmic,
            "colour": colour,
        }
        return decode(Measurements, self._transport.post(f"/v1/renders/{_part(render_id)}:measure", body))

    def regions(self, render_id: str) -> MeasuredRegions:
        """Parts of the film that are kept with the render to be measured."""
        return decode(MeasuredRegions, self._transport.get(f"/v1/renders/{_part(render_id)}/regions"))

    def keep_regions(self, render_id: str, regions: Sequence[Outline]) -> MeasuredRegions:
        """Keeps these with the render instead of all that were kept."""
        body = {"regions": [asdict(region) for region in regions]}
        path = f"/v1/renders/{_part(render_id)}/regions"
        call = partial(self._transport.send_json, "PUT", path, body)
        return decode(MeasuredRegions, self._transport.retrying(call))

    def isolines(self, render_id: str, levels: Sequence[float] = (), channel: str = "Y") -> Isolines:
        """Lines along which the image has these values; without levels, round numbers."""
        params = {"level": [*levels], "channel": channel}
        return decode(Isolines, self._transport.get(f"/v1/renders/{_part(render_id)}/isolines", params))

    def glare(
        self, render_id: str, azimuth: float = 0.0, elevation: float = 0.0, threshold: float | None = None
    ) -> Glare:
        """How much an eye that looks at a panorama is disturbed; directions in degrees from its middle."""
        params = {"azimuth": azimuth, "elevation": elevation}
        if threshold is not None:
            params["threshold"] = threshold
        return decode(Glare, self._transport.get(f"/v1/renders/{_part(render_id)}/glare", params))

    def annual(
        self,
        render_id: str,
        lux: float = 300.0,
        hours: tuple[float, float] = (8.0, 18.0),
        eyes: Sequence[str] = (),
        ground: float = 0.2,
    ) -> str:
        """A year of daylight as JSON, as `nocturne annual` writes it, of the group that a render of daylight
        coefficients is in. `lux` is enough; hours of the day from and to; instruments at eyes; reflectance of
        the ground beyond the scene."""
        first, last = hours
        params = {"lux": lux, "first_hour": first, "last_hour": last, "eye": [*eyes], "ground": ground}
        path = f"/v1/renders/{_part(render_id)}/annual.json"
        call = partial(self._transport.send, "GET", path, params=params, timeout=_PREFLIGHT_TIMEOUT)
        return self._transport.retrying(call).text

    def drain_worker(self, worker_id: str) -> None:
        """Gives a worker no more jobs; it finishes those that it has."""
        self._transport.retrying(
            partial(self._transport.send, "POST", f"/v1/workers/{_part(worker_id)}:drain")
        )

    def release_worker(self, worker_id: str) -> None:
        """Gives a worker in quarantine, or a drained one, jobs again, and takes its results."""
        self._transport.retrying(
            partial(self._transport.send, "POST", f"/v1/workers/{_part(worker_id)}:release")
        )

    def workers(self) -> Sequence[Worker]:
        """The workers heard of in the last ten seconds."""
        return [decode(Worker, each) for each in self._transport.get("/v1/workers")["workers"]]

    def work(self) -> Sequence[WorkOfWorker]:
        """Which renders the workers are tracing, and since when."""
        return [decode(WorkOfWorker, each) for each in self._transport.get("/v1/workers/work")["work"]]

    def tiles(self, render_id: str, since: str = "") -> "TileAnswer":
        """What of the image changed since an earlier answer's cursor, as floats; about 4 MiB at once.

        Needs numpy: the extra `pixels` of this package.
        """
        from nocturne_client.tiles import decode_tiles

        call = partial(
            self._transport.send, "GET", f"/v1/renders/{_part(render_id)}/tiles", params={"since": since}
        )
        return decode_tiles(self._transport.retrying(call).content)

    def create_webhook(self, url: str) -> NewWebhook:
        """Tells `url` how this caller's renders end; the only answer that has the secret."""
        # Not repeated: each call makes one.
        return decode(NewWebhook, self._transport.send_json("POST", "/v1/webhooks", {"url": url}))

    def webhooks(self) -> Sequence[Webhook]:
        """This caller's, oldest first; an admin gets everybody's."""
        return [decode(Webhook, each) for each in self._transport.get("/v1/webhooks")["webhooks"]]

    def delete_webhook(self, webhook_id: str) -> None:
        """Tells it nothing more."""
        self._transport.send("DELETE", f"/v1/webhooks/{_part(webhook_id)}")

    def watch(self, render_id: str) -> Iterator[Render]:
        """The render now and after every change, until it has ended. Connects again when cut off."""
        last: Render | None = None
        failures = 0
        # A service that was there once comes back; one that never was may have another address.
        while last is None or not last.has_ended:
            try:
                for state in self._watch_once(render_id, last):
                    last, failures = state, 0
                    yield state
            except NocturneClientError as error:
                delays = RETRY_DELAYS_S if last is None else _WATCH_DELAYS_S
                failures += 1
                if failures > len(delays):
                    raise
                self._transport.wait_for(error, delays[failures - 1], self._transport.patience_s)

    def download(self, render_id: str, kind: ImageKind, path: Path) -> Path:
        """Writes the image ("exr") or the preview ("png") as it is now, or the "scene" document; `path` is
        whole or untouched. A link stays one, and so does a device.

        "denoised_exr", "denoised_png": a picture without noise, to look at; "difference": where that leaves
        the true image by more than its error bar.
        """
        check_output(path)
        address = f"/v1/renders/{_part(render_id)}/{_PATHS[kind]}"
        try:
            with written(path) as file:
                come = _Come(file)
                self._transport.retrying(lambda: self._fetch_rest(address, come))
        except OSError as error:
            raise NocturneClientError(f"{path}: {error.strerror}") from error
        return path

    def session(self) -> tuple[Session, str]:
        """Who the caller is to the service, and the time of its answer as HTTP tells it."""
        answer = self._transport.send("GET", "/v1/session")
        return decode(Session, answer.json()), answer.headers.get("date", "")

    def is_ready(self) -> bool:
        """Whether the service answers."""
        try:
            self._transport.send("GET", "/readyz?exclude=merging")
        except NocturneClientError:
            return False
        return True

    def group(self, name: str) -> Group:
        """All renders of a group together."""
        return decode(Group, self._transport.get(f"/v1/groups/{_part(name)}"))

    def usage(self) -> Usage:
        """Use of the service by owner, with its cost."""
        return decode(Usage, self._transport.get("/v1/usage"))

    def list(self, limit: int = 50, group: str = "", tag: str = "", search: str = "") -> Sequence[Render]:
        """The newest renders, at most `limit`: of one group, with a tag, or with all words of a search in
        name, id, owner, state, group or tags, where these are given."""
        found: list[Render] = []
        token = ""
        while len(found) < limit:
            chosen = {"group": group, "tag": tag, "search": search}
            params = {"page_size": min(200, limit - len(found)), "page_token": token, **chosen}
            page = self._transport.get("/v1/renders", params=params)
            found += [decode(Render, each) for each in page["renders"]]
            token = page["next_page_token"]
            if not token:
                break
        return found

    # Inside

    def _act(self, render_id: str, verb: str, body: dict[str, Any]) -> Render:
        # Each of these is safe to repeat: it states the wanted state, not a change.
        return decode(Render, self._transport.post(f"/v1/renders/{_part(render_id)}:{verb}", body))

    def _missing(self, digests: Sequence[str]) -> Sequence[str]:
        if not digests:
            return []
        answer = self._transport.post("/v1/assets:batchMissing", {"sha256": [*digests]})
        return [str(sha256) for sha256 in answer["sha256"]]

    def _watch_once(self, render_id: str, last: Render | None) -> Iterator[Render]:
        headers = {"Last-Event-ID": str(last.sequence)} if last else {}
        path = f"/v1/renders/{_part(render_id)}/events"
        with self._transport.stream("GET", path, headers=headers, timeout=_WATCH_TIMEOUT) as response:
            for event in EventSource(response).iter_sse():
                # A comment after an event comes as one without data.
                if event.data:
                    yield decode(Render, json.loads(event.data))

    def _fetch_rest(self, address: str, come: "_Come") -> None:
        """The rest of a file; all of it where that is another one by now."""
        headers = {"Range": f"bytes={come.size}-", "If-Range": come.etag} if come.size and come.etag else {}
        with self._transport.stream("GET", address, headers=headers) as response:
            if come.size and response.status_code != httpx.codes.PARTIAL_CONTENT:
                come.file.seek(0)
                come.file.truncate()
                come.size = 0
            come.etag = response.headers.get("etag", "")
            for piece in response.iter_bytes():
                come.file.write(piece)
                come.size += len(piece)

    def _uploaded(self, scene: Path, progress: UploadProgress | None) -> SceneOnDisk:
        """A scene whose files the service has."""
        on_disk = read_scene(scene)
        self._send(on_disk.files, progress)
        return on_disk

    def _send(self, files: Mapping[str, Path], progress: UploadProgress | None) -> None:
        """Uploads those of the files, by SHA-256, that the service lacks."""
        for sha256 in self._missing(sorted(files)):
            self.upload(files[sha256], sha256, progress)


@dataclass
class _Come:
    """The part of a file that has come by now."""

    file: IO[bytes]
    etag: str = ""
    """Of the whole."""
    size: int = 0


def _stem(scene: Path | SceneOnDisk) -> str:
    return scene.stem if isinstance(scene, Path) else ""


def _part(text: str) -> str:
    """One part of a path: what the user typed must not lead elsewhere."""
    return quote(text, safe="")


def _pieces(path: Path, progress: UploadProgress | None) -> Iterator[bytes]:
    size, sent = path.stat().st_size, 0
    with path.open("rb") as file:
        while piece := file.read(_PIECE_BYTES):
            yield piece
            sent += len(piece)
            if progress is not None:
                progress(path, sent, size)
