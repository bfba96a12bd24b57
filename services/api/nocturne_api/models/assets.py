"""Assets: files by content."""

from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer, RequestBody


class Asset(Answer):
    """A stored file."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.ASSET]})

    sha256: str = Field(description="Lower-case hexadecimal.")
    size_bytes: int


class BatchMissingRequest(RequestBody):
    """The files that a caller is about to upload."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"sha256": [examples.SHA256]}]})

    sha256: list[str] = Field(description="SHA-256 digests, lower-case hexadecimal.")


class BatchMissingResponse(Answer):
    """Those of the files that the service does not have, in the order asked."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"sha256": [examples.SHA256]}]})

    sha256: list[str]
