"""`nocturne validate`."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nocturne_client.cli.output import AsJson, print_json
from nocturne_client.console import CONSOLE

if TYPE_CHECKING:
    from nocturne_scene.validation.cases import Suite
    from nocturne_scene.validation.verdict import Reading

    from nocturne_client.local.validating import Validation


def add_to(app: typer.Typer) -> None:
    """Adds this command to the program."""
    app.command()(validate)


def validate(
    suites: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SUITE",
            help="cie171, lamps, factors, enclosures, glass, films, media, polarisation, colours, "
            "wavelengths; all without.",
            show_default=False,
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="An eighth of the scenes; below a minute.")] = False,
    page: Annotated[
        Path | None, typer.Option("--page", metavar="OUT.html", help="Write a page that needs no other file.")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of all random numbers.")] = 0,
    threads: Annotated[int, typer.Option("--threads", min=0, help="0: one per processor.")] = 0,
    as_json: AsJson = False,
) -> None:
    """Render scenes whose readings are known, by closed forms and published numbers, and say how far off they
    are.

    Each value has its 95 % interval and its z, the deviation in standard errors. Exit status 1 if chance
    does not explain the deviations.
    """
    from nocturne_client.local import validating
    from nocturne_client.local.validation_page import page as page_of
    from nocturne_client.outputs import check_output

    chosen = validating.chosen_suites(suites or [])
    if page is not None:
        check_output(page)
    threads = threads or len(os.sched_getaffinity(0))
    told = (lambda _: None) if as_json else _Telling(chosen)
    found = validating.validate(chosen, quick=quick, seed=seed, threads=threads, told=told)
    if page is not None:
        page.write_text(page_of(found), encoding="utf-8")
    if as_json:
        print_json(validating.as_json(found))
    else:
        _print_verdicts(chosen, found)
    raise typer.Exit(int(not found.verdict.is_good))


class _Telling:
    """Prints a line for each reading, below its suite and the source of its truth."""

    def __init__(self, suites: "Sequence[Suite]") -> None:
        self._abouts = {suite.name: suite.about for suite in suites}
        self._suite = self._source = ""

    def __call__(self, reading: "Reading") -> None:
        if reading.suite != self._suite:
            CONSOLE.print(f"\n{self._abouts[reading.suite]}", style="bold", markup=False, highlight=False)
        if reading.value.source != self._source:
            _print(f"  by {reading.value.source}")
        self._suite, self._source = reading.suite, reading.value.source
        z = "exact" if reading.z is None else f"z {reading.z:+.2f}"
        read = f"{reading.found:.6g} +- {reading.half_interval:.1g}"
        _print(f"    {reading.value.name}: {read}, truth {reading.value.truth:.6g}, {z}")


def _print_verdicts(suites: "Sequence[Suite]", found: "Validation") -> None:
    from nocturne_scene.validation.verdict import verdict

    from nocturne_client.local.validation_page import sentence

    CONSOLE.print()
    for suite in suites:
        _print(f"{suite.about}: {sentence(verdict(found.of(suite.name)))}")
    made = f"Engine {found.engine}, {found.seconds:.0f} s, {found.machine}."
    _print(f"All: {sentence(found.verdict)} {made}")


def _print(text: str) -> None:
    CONSOLE.print(text, markup=False, highlight=False, soft_wrap=True)
