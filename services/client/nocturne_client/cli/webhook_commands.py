"""Webhooks: addresses that a service notifies of ends of renders."""

from dataclasses import asdict
from typing import Annotated

import typer

from nocturne_client.cli.output import AsJson, Url, print_json
from nocturne_client.client import Client

app = typer.Typer(
    name="webhook", help="Tell an address how your renders end, in signed messages.", no_args_is_help=True
)


@app.command()
def create(
    address: Annotated[str, typer.Argument(metavar="URL", help="https, and a public address.")],
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Make a webhook; prints its id and the secret that signs its messages, which can't be had again."""
    with Client(url) as client:
        made = client.create_webhook(address)
    print_json(asdict(made)) if as_json else typer.echo(f"{made.id}  {made.secret}")


@app.command(name="list")
def list_webhooks(url: Url = None, as_json: AsJson = False) -> None:
    """List your webhooks, and how the last message of each went."""
    with Client(url) as client:
        for webhook in client.webhooks():
            if as_json:
                print_json(asdict(webhook))
            else:
                typer.echo(f"{webhook.id}  {webhook.url}  {webhook.last_outcome or 'nothing told yet'}")


@app.command()
def delete(
    webhook_id: Annotated[str, typer.Argument(metavar="ID", help="As printed by list.")], url: Url = None
) -> None:
    """Tell this address nothing more."""
    with Client(url) as client:
        client.delete_webhook(webhook_id)
