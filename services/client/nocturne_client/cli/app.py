"""The program: all commands, and the one place where errors become messages and exit statuses."""

import io
import sys
from typing import Annotated

import typer

from nocturne_client.cli import (
    annual_command,
    compare_commands,
    demo_command,
    help_panels,
    light_commands,
    local_commands,
    measure_commands,
    parts_commands,
    preflight_command,
    report_command,
    service_commands,
    token_commands,
    up_commands,
    validate_command,
    webhook_commands,
    year_command,
)
from nocturne_client.cli.output import ExitStatus, print_error
from nocturne_client.console import ERRORS
from nocturne_client.errors import NocturneClientError, NotReachedError
from nocturne_client.version import installed_version

app = typer.Typer(
    name="nocturne",
    help="""Render scenes into spectral images in absolute units (cd/m2, lx, cd), with error bars.

    One image, here: nocturne render scene.json -o image.exr --error 2%

    On a service: nocturne up, and in another shell nocturne submit scene.json --error 2% --watch

    Missing programs: nocturne doctor
    """,
    epilog="Exit status: 0 done; 1 failed, or images differ; 2 wrong arguments or input; 3 no service there; "
    "4 some tiles lack samples; 130 interrupted.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
# What brings a package that a command needs and this one does not: an extra of nocturne.
_EXTRAS = {"numpy": "pixels"}
_SERVICE = "all"


def _show_version(asked: bool) -> None:
    if asked:
        typer.echo(f"nocturne {installed_version()}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True)
    ] = False,
) -> None:
    """Options of the program itself."""


service_commands.add_to(app)
up_commands.add_to(app)
demo_command.add_to(app)
local_commands.add_to(app)
compare_commands.add_to(app)
measure_commands.add_to(app)
light_commands.add_to(app)
parts_commands.add_to(app)
preflight_command.add_to(app)
validate_command.add_to(app)
annual_command.add_to(app)
year_command.add_to(app)
report_command.add_to(app)
app.add_typer(token_commands.app)
app.add_typer(webhook_commands.app)
help_panels.arrange(app)


def main() -> None:
    """Runs the command line; user errors end in one message, never in a traceback."""
    for stream in (sys.stdout, sys.stderr):
        # What a terminal has no letters for is shown by its number.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        app()
    except NocturneClientError as error:
        print_error(error)
        sys.exit(ExitStatus.NOT_REACHED if isinstance(error, NotReachedError) else ExitStatus.WRONG)
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("nocturne_client"):
            raise
        print_error(_missing_package(error))
        sys.exit(ExitStatus.FAILED)
    except KeyboardInterrupt:
        ERRORS.print("interrupted")
        sys.exit(ExitStatus.INTERRUPTED)
    except BrokenPipeError:
        sys.exit(ExitStatus.OK)


def _missing_package(error: ModuleNotFoundError) -> NocturneClientError:
    """Commands import their modules when they run: with the client alone, the service's are missing."""
    package = (error.name or "").partition(".")[0]
    extra = _EXTRAS.get(package, _SERVICE)
    return NocturneClientError(
        f"this command needs the package {package}, which is not installed; "
        f'install it with: pip install "nocturne[{extra}]"'
    )
