"""Problems: every error of the REST endpoint, as RFC 9457 problem details."""

from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer


class Problem(Answer):
    """One thing wrong with a request."""

    place: str = Field(description="Where: `$.scene.surfaces[3].kernel` in the body, `query.page_size`, ...")
    message: str


class ProblemDetails(Answer):
    """RFC 9457 problem details."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.PROBLEM]})

    type: str = "about:blank"
    title: str
    status: int = Field(description="The HTTP status.")
    detail: str = Field(description="What was wrong, in words.")
    reason: str = Field(description="The same in one word for programs; see the table of errors.")
    problems: list[Problem] = Field(default=[], description="At most 20, with their places.")
