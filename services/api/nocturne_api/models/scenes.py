"""Scenes in requests, imports of other renderers' scenes, and preflights, which say what a scene needs."""

from typing import Annotated, Any

from pydantic import ConfigDict, Field

from nocturne_api.limits import PREFLIGHT_BUDGET_S
from nocturne_api.models import examples
from nocturne_api.models.base import Answer, RequestBody, SchemaOf
from nocturne_api.models.problems import Problem


class SceneDocument(RequestBody):
    """A scene, by the JSON Schema at /scene.schema.json (docs/reference/scene.md); assets by `sha256:...`.

    The schema of `scene` in requests. The scene language's own rules check it, with all problems at once.
    """

    model_config = ConfigDict(extra="allow", json_schema_extra={"examples": [examples.SCENE]})


Scene = Annotated[dict[str, Any], SchemaOf(SceneDocument)]


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
        default=False, description="Leave out parts that are not supported here, instead of an error."
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
    notes: list[str] = Field(description="Parts that are expressed differently.")
    missing: list[Problem] = Field(description="Parts that were left out.")


class PreflightRequest(RequestBody):
    """A scene, and the error that is wanted of its image."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.PREFLIGHT]})

    scene: Scene = Field(description="Files that it names are uploaded before.")
    width: int = Field(default=512, description="Film of the real render, pixels.")
    height: int = Field(default=512, description="Film of the real render, pixels.")
    error: float = Field(
        default=0.02, description="Total relative error, bias and noise together, in (0, 1)."
    )
    budget_seconds: float = Field(
        default=60.0,
        description=f"Processor time of the small renders, about; at most {PREFLIGHT_BUDGET_S:g}.",
    )


class Interval(Answer):
    """An estimate, and the interval that holds the truth with 95 %."""

    value: float
    low: float
    high: float


class Pilot(Answer):
    """The small renders that the report goes by."""

    film: list[int] = Field(description="Width and height, pixels.")
    samples: int = Field(description="Per pixel of each render.")
    renders: int = Field(description="Independent renders of each model.")
    cpu_seconds: float = Field(description="What they took.")
    recommended_cpu_seconds: float | None = Field(
        description="A budget that would show biases of half of the target; null: this one does."
    )
    effective_pixels: float = Field(description="As in Progress.")
    heavy_tails: bool = Field(
        description="Rare samples carry the noise: intervals and times are not to be trusted."
    )


class PreflightModel(Answer):
    """The scene with some parts less. Errors are relative."""

    without: list[str] = Field(description="Parts that are left out; empty: none.")
    verdict: str
    mean_bias: Interval = Field(description="Of the mean luminance.")
    local_bias: Interval = Field(description="Relative RMSE over pixels of the change.")
    noise_of_a_sample: float = Field(description="Relative RMSE over pixels of one sample per pixel.")
    cost_ratio: Interval = Field(description="Time of a sample, relative to the full model.")
    samples: int | None = Field(description="Per pixel, to the target; null: out of reach.")
    cpu_seconds: float | None = Field(description="Of one processor, to the target; null: out of reach.")


class PreflightReport(Answer):
    """What a scene needs for an error."""

    error: float = Field(description="The target.")
    film: list[int] = Field(description="Width and height of the real render, pixels.")
    pilot: Pilot
    full: PreflightModel
    models: list[PreflightModel] = Field(description="Each with one part less.")
    chosen: PreflightModel = Field(description="The cheapest that stays within the target.")
    saving: float = Field(description="How many times faster than the full model it gets there.")
    without_effect: list[str] = Field(description="Parts that change nothing in the traced scene.")
    document: Scene = Field(description="The scene document of the chosen model.")
