"""What counts in a year of daylight, wherever it was traced."""

from typing import Annotated

import typer

EnoughLux = Annotated[float, typer.Option("--lux", min=0.001, help="Illuminance that counts as enough, lx.")]
CountedHours = Annotated[
    tuple[float, float],
    typer.Option("--hours", help="Hours of the day in which light counts, from and to."),
]
GroundReflectance = Annotated[
    float, typer.Option("--ground", min=0, max=1, help="Reflectance of the ground beyond the scene.")
]
