"""Says that the wheel is for one kind of machine, and any Python. Read by hatchling."""

from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class ForOneKindOfMachine(BuildHookInterface[Any]):
    """Tags the wheel; `auditwheel repair` then says how old a Linux it runs on."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        build_data["pure_python"] = False
        build_data["tag"] = "py3-none-linux_x86_64"
