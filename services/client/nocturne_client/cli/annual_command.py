"""`nocturne annual`."""

import os
from pathlib import Path
from typing import Annotated

import typer

from nocturne_client.cli.local_commands import Threads
from nocturne_client.cli.output import AsJson, print_json
from nocturne_client.cli.scene_options import ScenePath, Settings, changes_of
from nocturne_client.cli.year_options import CountedHours, EnoughLux, GroundReflectance
from nocturne_client.console import CONSOLE, ERRORS
from nocturne_client.errors import NocturneClientError

_PATCHES = {145: 1, 577: 2, 2305: 4}
_TABLE, _HOURS = "--table", "--hours-table"


def add_to(app: typer.Typer) -> None:
    """Adds this command to the program."""
    app.command()(annual)


def annual(
    scene: ScenePath,
    weather: Annotated[
        Path, typer.Option("--weather", metavar="FILE.epw", help="Irradiances of each hour of a year.")
    ],
    output: Annotated[
        list[Path] | None,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT.json|.svg",
            help="All figures, or plan and year as a picture; may be repeated.",
        ),
    ] = None,
    table: Annotated[
        Path | None, typer.Option(_TABLE, metavar="OUT.csv", help="A line for each point.")
    ] = None,
    hours_table: Annotated[
        Path | None,
        typer.Option(_HOURS, metavar="OUT.csv", help="A line for each hour: the mean of the points."),
    ] = None,
    patches: Annotated[int, typer.Option("--patches", help="Patches of the sky: 145, 577 or 2305.")] = 577,
    sun_patches: Annotated[
        int,
        typer.Option("--sun-patches", help="Patches for sunlight via surfaces: 145, 577 or 2305."),
    ] = 2305,
    samples: Annotated[int, typer.Option("--samples", min=64, help="Samples of each point, at most.")] = 8192,
    batches: Annotated[
        int, typer.Option("--batches", min=32, max=256, help="Independent batches, for the intervals.")
    ] = 32,
    sure: Annotated[
        float,
        typer.Option(
            "--sure",
            min=0.5,
            max=1.0,
            help="Stop when verdicts about sDA hold or fail with this probability.",
        ),
    ] = 0.99,
    lux: EnoughLux = 300.0,
    hours: CountedHours = (8.0, 18.0),
    north: Annotated[
        str,
        typer.Option(
            "--north", metavar="X,Y,Z", help="Direction of north. Default: that of the scene's sky, or -z."
        ),
    ] = "",
    ground: GroundReflectance = 0.2,
    blinds: Annotated[
        Path | None,
        typer.Option(
            "--blinds",
            metavar="SCENE.json",
            help="The same scene with its blinds closed: in hours in which more than 2 % of the points have "
            "1000 lx or more straight from the Sun (LM-83-12), or by --schedule.",
        ),
    ] = None,
    schedule: Annotated[
        Path | None,
        typer.Option(
            "--schedule", metavar="FILE", help="8760 lines, 1 for each hour with closed blinds, else 0."
        ),
    ] = None,
    eye: Annotated[
        list[str] | None,
        typer.Option(
            "--eye",
            metavar="NAME",
            help="An instrument at an eye, of an upright plane: simplified DGP; it is no point of the room.",
        ),
    ] = None,
    melanopic: Annotated[
        bool, typer.Option("--melanopic", help="Also melanopic EDI, in twice the time; all daylight is D65.")
    ] = False,
    threads: Threads = 0,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Seed instead of the scene's own.")
    ] = None,
    settings: Settings = None,
    as_json: AsJson = False,
) -> None:
    """A year of daylight at the meters of a scene: daylight autonomy, useful illuminance, sDA and ASE, each
    with its interval and verdicts with their probability. Runs on this machine without a service.

    The scene's own sky and lamps are left out. One trace serves all hours.
    """
    import numpy as np
    from nocturne_scene.daylight.coefficients import Layout
    from nocturne_scene.daylight.metrics import GROUPS
    from nocturne_scene.daylight.patches import Patches
    from nocturne_scene.daylight.plain_year import as_json as plain

    from nocturne_client.local import annual_files
    from nocturne_client.local.annual import Annual, study
    from nocturne_client.local.daylight_rounds import Rounds
    from nocturne_client.outputs import check_output

    if schedule is not None and blinds is None:
        raise NocturneClientError("--schedule is of blinds; expected --blinds, too")
    if batches % GROUPS:
        raise NocturneClientError(f"--batches {batches}: expected a multiple of {GROUPS}")
    for option, count in (("--patches", patches), ("--sun-patches", sun_patches)):
        if count not in _PATCHES:
            raise NocturneClientError(f"{option} {count}: expected 145, 577 or 2305")
    for path in output or []:
        if path.suffix.lower() not in annual_files.WRITERS:
            raise NocturneClientError(f"{path}: expected a name that ends in .json or .svg")
    writers = [(path, annual_files.WRITERS[path.suffix.lower()]) for path in output or []]
    writers += [(table, annual_files.points_csv)] if table else []
    writers += [(hours_table, annual_files.hours_csv)] if hours_table else []
    for path, _ in writers:
        check_output(path)
    asked = Annual(
        scene=scene,
        weather=weather,
        layout=Layout(Patches(_PATCHES[patches]), Patches(_PATCHES[sun_patches])),
        rounds=Rounds(batches, max(2, samples // batches), threads or len(os.sched_getaffinity(0)), seed),
        north=None if not north else np.array(_three(north)),
        ground_reflectance=ground,
        hours=hours,
        lux=lux,
        sure=sure,
        changes=changes_of(settings, "", ""),
        blinds=blinds,
        schedule=schedule,
        eyes=tuple(eye or ()),
        melanopic=melanopic,
    )
    found = study(asked, lambda said: ERRORS.print(said, markup=False, soft_wrap=True, highlight=False))
    for path, made in writers:
        annual_files.write(path, made(found))
    if as_json:
        print_json(plain(found))
        return
    for line in annual_files.lines(found):
        CONSOLE.print(line, markup=False, highlight=False)


def _three(text: str) -> list[float]:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 3 or not any(numbers):
        raise NocturneClientError(f"--north {text}: expected three numbers, such as 0,0,-1")
    return numbers
