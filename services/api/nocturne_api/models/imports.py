"""Imports: scenes of other renderers become scene documents."""

from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer, RequestBody
from nocturne_api.models.problems import Problem
from nocturne_api.models.renders import Scene


class ImportRequest(RequestBody):
    """Files of a scene that was made for another renderer: Mitsuba 3, pbrt-v4, glTF 2.0."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.IMPORT]})

    files: dict[str, str] = Field(
        description="SHA-256 digests of uploaded files, by the paths that they have for each other; a ZIP "
        "archive is one file."
    )
    scene: str = Field(
        default="", description="Which of them is the scene. Default: the one nearest to the top."
    )
    allow_missing: bool = Field(
        default=False, description="Leave out what has no equal here, instead of an error."
    )
    light: str = Field(
        default="",
        description="Light around the scene: `sky`, `studio`, or the path of a picture among the files. "
        "Default: `sky` where nothing emits.",
    )
    time: float | None = Field(default=None, description="Seconds into an animation. Default: at rest.")
    parameters: dict[str, str] = Field(default={}, description="Values of `$name` in Mitsuba's files.")


class ImportedScene(Answer):
    """A scene that was imported; its files are stored."""

    document: Scene = Field(description="The scene document.")
    scene: str = Field(description="Path of the file that it was made of.")
    width: int = Field(description="Of the file's film, pixels.")
    height: int = Field(description="Of the file's film, pixels.")
    samples: int | None = Field(description="Per pixel, as the file says; null: it does not.")
    notes: list[str] = Field(description="What is expressed in another way.")
    missing: list[Problem] = Field(description="What was left out.")
