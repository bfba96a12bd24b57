"""Readiness of the service, and its failed checks."""

from typing import Literal, get_args

from pydantic import ConfigDict, Field

from nocturne_api.models.base import Answer

CheckName = Literal["reading", "writing", "admission", "merging"]
CHECKS: tuple[CheckName, ...] = get_args(CheckName)


class Check(Answer):
    """One thing that the service must be able to do."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"name": "writing", "ok": True, "trouble": ""}]}
    )

    name: CheckName = Field(
        description="reading, writing: the data folder; admission: new renders are taken; merging: a "
        "coordinator is alive, and commits results."
    )
    ok: bool
    trouble: str = Field(description="The fault, for people; empty: none.")


class Readiness(Answer):
    """Whether all checks passed, and each of them."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [{"ready": True, "checks": [{"name": "writing", "ok": True, "trouble": ""}]}]
        }
    )

    ready: bool
    checks: list[Check]
