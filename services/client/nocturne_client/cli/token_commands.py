"""Tokens of a data folder on this machine: whoever can write to it may make them."""

from pathlib import Path
from typing import Annotated

import typer

from nocturne_client.cli.output import AsJson, print_json

app = typer.Typer(
    name="token", help="Make, list and revoke API tokens of a data folder here.", no_args_is_help=True
)

Data = Annotated[
    Path | None, typer.Option("--data", help="Data folder. Default: yours, as for `nocturne up`.")
]


@app.command()
def create(
    name: Annotated[str, typer.Argument(help="Who it is for; renders carry it.")],
    scope: Annotated[
        list[str],
        typer.Option(
            "--scope",
            help="read (everybody's renders), submit (make renders, see and change one's own), worker, "
            "admin; may be given several times.",
        ),
    ],
    weight: Annotated[int, typer.Option("--weight", help="1 to 1000; share of the workers.")] = 100,
    data: Data = None,
) -> None:
    """Make a token and print its secret, which can't be had again."""
    from nocturne_client.local.tokens import create_token

    typer.echo(create_token(data, name, scope, weight))


@app.command(name="list")
def list_tokens(data: Data = None, as_json: AsJson = False) -> None:
    """List tokens, without their secrets."""
    from nocturne_client.local.tokens import list_tokens as found

    for token in found(data):
        if as_json:
            print_json(token)
        else:
            state = "revoked" if token["revoked"] else " ".join(token["scopes"])
            typer.echo(f"{token['name']}  {state}  weight {token['weight']}")


@app.command()
def revoke(name: str, data: Data = None) -> None:
    """Let nobody in with this token any more."""
    from nocturne_client.local.tokens import revoke_token

    revoke_token(data, name)
