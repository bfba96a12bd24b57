"""All operations on one data folder, by resource, and the background work."""

import asyncio
from pathlib import Path
from typing import Self

from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.quotas import NO_QUOTA, Quota
from nocturne_coordinator.traces import Traces

from nocturne_api import limits
from nocturne_api.access import Caller, caller_of
from nocturne_api.background.archiver import Archiver
from nocturne_api.background.garbage_collector import GarbageCollector
from nocturne_api.background.layer_builder import LayerBuilder
from nocturne_api.background.space import DiskQuota, StorageLimits
from nocturne_api.compiling.pool import CompileLimits, prepare
from nocturne_api.errors import Unauthenticated
from nocturne_api.models.workers import CoreHourPrice
from nocturne_api.operations.annual import Annual
from nocturne_api.operations.assets import Assets
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.health import Health
from nocturne_api.operations.images import Bundles, Denoised, Images
from nocturne_api.operations.measurements import Measurements
from nocturne_api.operations.readiness import Readiness
from nocturne_api.operations.readings import LearnedLights, Readings
from nocturne_api.operations.render_controls import RenderControls
from nocturne_api.operations.render_streams import RenderStreams
from nocturne_api.operations.renders import Groups, Renders
from nocturne_api.operations.reports import Reports
from nocturne_api.operations.scenes import Imports, Preflights
from nocturne_api.operations.webhooks import Webhooks
from nocturne_api.operations.workers import Machines, UsageReports, Workers
from nocturne_api.webhooks.sender import WebhookSender
from nocturne_api.webhooks.targets import TargetRules


class Operations:
    """What the service can do. Errors are the classes in nocturne_api.errors, whatever the transport."""

    def __init__(
        self,
        access: FolderAccess,
        compile_limits: CompileLimits,
        webhook_rules: TargetRules,
        storage: StorageLimits,
        price: CoreHourPrice,
        traces: Traces,
    ) -> None:
        self._traces = traces
        folder = access.folder
        objects = folder.object_store
        archiver = None if objects is None else Archiver(folder, access.writing, objects)
        garbage_collector = GarbageCollector(folder, storage.unused_seconds)
        space = DiskQuota(folder.root, storage.data_bytes)
        layer_builder = LayerBuilder(folder, access.writing, compile_limits, space)
        sender = WebhookSender(folder.webhooks, access.writing, webhook_rules)
        self._access = access
        self._background = [
            sender,
            *([archiver] if archiver else []),
            garbage_collector,
            space,
            layer_builder,
        ]

        self.renders = Renders(access, compile_limits, garbage_collector, space, layer_builder, self._traces)
        self.controls = RenderControls(access)
        self.streams = RenderStreams(access, self.renders)
        self.images = Images(access, self.renders, archiver)
        self.bundles = Bundles(access, self.renders)
        self.groups = Groups(access)
        self.denoised = Denoised(self.renders, self.images)
        self.readings = Readings(access, self.renders)
        self.learned_lights = LearnedLights(access, self.renders, compile_limits)
        self.measurements = Measurements(access, self.renders)
        self.annual = Annual(access, self.renders, compile_limits)
        self.reports = Reports(access, self.renders, self.images, self.annual, compile_limits)
        self.preflights = Preflights(access, compile_limits)
        self.workers = Workers(access)
        self.usage = UsageReports(access, price)
        self.machines = Machines(access)
        self.webhooks = Webhooks(access, webhook_rules)
        self.assets = Assets(access, space)
        self.imports = Imports(access, self.assets)
        self.health = Health(access, space)
        self.readiness = Readiness(access, self.renders)

        for task in self._background:
            task.start()

    @classmethod
    async def open(
        cls,
        path: Path,
        compile_limits: CompileLimits | None = None,
        webhook_rules: TargetRules | None = None,
        objects: ObjectStore | None = None,
        quota: Quota = NO_QUOTA,
        storage: StorageLimits | None = None,
        price: CoreHourPrice | None = None,
        traces: Traces | None = None,
    ) -> Self:
        """Opens the data folder at `path`, making it if need be."""
        access = await FolderAccess.open(path, objects, quota)
        prepare()
        rules = webhook_rules or TargetRules()
        return cls(
            access,
            compile_limits or CompileLimits(),
            rules,
            storage or StorageLimits(),
            price or CoreHourPrice(),
            traces or Traces(),
        )

    def check_folder(self) -> None:
        """Raises FolderGone where the data folder was moved away or replaced. Microseconds."""
        self._access.folder.check_place()

    async def identify(self, secret: str) -> Caller:
        """Who has the token with this secret; raises Unauthenticated."""
        return caller_of(await self._access.in_database(self._access.folder.tokens.find, secret))

    async def identify_session(self, name: str) -> Caller:
        """Who began the session of the page with this name; raises Unauthenticated where it has ended."""
        find = self._access.folder.sessions.token
        token = await self._access.in_database(find, name, limits.SESSION_SECONDS)
        if token is None:
            raise Unauthenticated("the session has ended; give the token again")
        return caller_of(token)

    async def begin_session(self, secret: str) -> str:
        """The name of a new session of the page for who has the secret; all that serve the folder know it."""
        begin = self._access.folder.sessions.begin
        return await self._access.writing(begin, secret, limits.SESSIONS, limits.SESSION_SECONDS)

    async def end_session(self, name: str) -> None:
        """Nobody gets in with it any more."""
        await self._access.writing(self._access.folder.sessions.end, name)

    async def close(self) -> None:
        """Ends all streams and lets go of the data folder."""
        await self.streams.close()
        for task in self._background:
            await task.close()
        self.denoised.close()
        await self._access.close()
        await asyncio.to_thread(self._traces.close)
