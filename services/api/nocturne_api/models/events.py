"""Events: what the streams of server-sent events carry besides renders."""

from pydantic import Field

from nocturne_api.models.base import Answer


class TilesEvent(Answer):
    """Which tiles of a render have new samples: the data of an event `tiles`."""

    render: str = Field(description="Its id.")
    revision: int = Field(description="The render's sequence.")
    tiles: list[tuple[int, int]] = Field(description="First and last indices of runs of tiles.")
