"""Preflights: what a scene needs for a target error, and what each of its parts changes and costs."""

from pydantic import ConfigDict, Field

from nocturne_api.limits import PREFLIGHT_BUDGET_S
from nocturne_api.models import examples
from nocturne_api.models.base import Answer, RequestBody
from nocturne_api.models.renders import Scene


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
    wanted_cpu_seconds: float | None = Field(
        description="A budget that would show biases of half of the target; null: this one does."
    )
    effective_sample_size_of_pixels: float = Field(description="As in Progress.")
    heavy_tails: bool = Field(
        description="Rare samples carry the noise: intervals and times are not to be trusted."
    )


class PreflightModel(Answer):
    """The scene with some parts less. Errors are relative."""

    without: list[str] = Field(description="What is left out; empty: nothing.")
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
    without_effect: list[str] = Field(description="Parts that change nothing of what is traced.")
    document: Scene = Field(description="The scene document of the chosen model.")
