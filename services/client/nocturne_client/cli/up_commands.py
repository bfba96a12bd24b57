"""Commands that start and stop a service on this machine. They import their modules when they run."""

import os
from pathlib import Path
from typing import Annotated

import typer

Port = Annotated[int, typer.Option("--port", min=1, max=65534, help="Page and REST; gRPC is one above.")]
DataOfService = Annotated[
    Path | None, typer.Option("--data", help="Data folder of the service. Default: yours.")
]


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    for command in (up, down):
        app.command()(command)


def up(
    data: Annotated[
        Path | None, typer.Option("--data", help="Data folder: renders, images, assets. Default: yours.")
    ] = None,
    port: Port = 7070,
    workers: Annotated[int, typer.Option("--workers", min=0, help="Worker processes.")] = 1,
    threads: Annotated[
        int, typer.Option("--threads", min=0, help="Per worker; 0: share the processors.")
    ] = 0,
    auth: Annotated[
        bool,
        typer.Option("--auth", help="Callers need a token; where there is none yet, one is made and shown."),
    ] = False,
    data_bytes: Annotated[
        float | None,
        typer.Option(
            "--data-bytes", min=0, help="Size of the data folder at which it takes no more; 0: none."
        ),
    ] = None,
    unused_seconds: Annotated[
        float | None,
        typer.Option("--unused-seconds", min=0, help="How long files stay that no render uses; else a week."),
    ] = None,
    owner_open_renders: Annotated[
        float | None,
        typer.Option(
            "--owner-open-renders", min=0, help="With --auth: each token's queued and running renders."
        ),
    ] = None,
    owner_open_samples: Annotated[
        float | None,
        typer.Option(
            "--owner-open-samples", min=0, help="With --auth: samples of pixels that these ask for."
        ),
    ] = None,
    owner_stored_bytes: Annotated[
        float | None,
        typer.Option(
            "--owner-stored-bytes", min=0, help="With --auth: each token's uploads, images and scenes."
        ),
    ] = None,
    core_hour_price: Annotated[
        float | None,
        typer.Option(
            "--core-hour-price", min=0, help="Price of an hour of one processor; shows what renders cost."
        ),
    ] = None,
    currency: Annotated[
        str | None, typer.Option("--currency", help="Currency of that price; default: EUR.")
    ] = None,
    webhook_network: Annotated[
        str | None,
        typer.Option(
            "--webhook-network",
            metavar="CIDR",
            help="A private network that webhooks may lead to, also by http, such as 127.0.0.1/32.",
        ),
    ] = None,
) -> None:
    """Run the whole service here: redis-server, coordinator, API with page, workers. Ctrl-C stops it."""
    from nocturne_client.local.data import default_data_folder
    from nocturne_client.local.up import UpSettings, run_up

    share = max(1, len(os.sched_getaffinity(0)) // max(1, workers))
    folder = (data or default_data_folder()).absolute()
    options = {
        "--data-bytes": data_bytes,
        "--unused-seconds": unused_seconds,
        "--owner-open-renders": owner_open_renders,
        "--owner-open-samples": owner_open_samples,
        "--owner-stored-bytes": owner_stored_bytes,
        "--core-hour-price": core_hour_price,
        "--currency": currency,
        "--webhook-network": webhook_network,
    }
    asked = {option: f"{value}" for option, value in options.items() if value is not None}
    run_up(UpSettings(folder, port, workers, threads or share, auth, asked))


def down(
    data: DataOfService = None,
) -> None:
    """Stop the service that runs here on a data folder: one that `nocturne up` or `nocturne demo` started."""
    from nocturne_client.local.data import default_data_folder
    from nocturne_client.local.down import run_down

    run_down((data or default_data_folder()).absolute())
