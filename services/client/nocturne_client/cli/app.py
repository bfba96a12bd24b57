"""The program: all commands, and the one place where errors become messages and exit statuses."""

import sys

import typer

from nocturne_client.cli import (
    local_commands,
    preflight_command,
    service_commands,
    token_commands,
    webhook_commands,
)
from nocturne_client.cli.output import ERRORS, ExitStatus, print_error
from nocturne_client.errors import NocturneClientError, NotReachedError

app = typer.Typer(
    name="nocturne",
    help="Render scenes into spectral images in absolute units, with error bars.",
    epilog="Exit status: 0 done; 1 the render failed or was cancelled, or something is missing; "
    "2 wrong arguments or input; 3 no service there; 4 some tiles of the image lack samples; "
    "130 interrupted.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
service_commands.add_to(app)
local_commands.add_to(app)
preflight_command.add_to(app)
app.add_typer(token_commands.app)
app.add_typer(webhook_commands.app)


def main() -> None:
    """Runs the command line; user errors end in one message, never in a traceback."""
    try:
        app()
    except NocturneClientError as error:
        print_error(error)
        sys.exit(ExitStatus.NOT_REACHED if isinstance(error, NotReachedError) else ExitStatus.WRONG)
    except KeyboardInterrupt:
        ERRORS.print("interrupted")
        sys.exit(ExitStatus.INTERRUPTED)
    except BrokenPipeError:
        sys.exit(ExitStatus.OK)
