"""Sessions: who calls, for the page."""

from pydantic import ConfigDict, Field

from nocturne_api.models.base import Answer


class Session(Answer):
    """Who the caller is."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"name": "studio", "scopes": ["read", "submit"]}]}
    )

    name: str = Field(description="Of the token; empty without authentication.")
    scopes: list[str] = Field(description="Of read, submit, worker and admin.")
