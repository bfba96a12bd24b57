"""The command line `nocturne`."""

from nocturne_client.cli.app import main

__all__ = ["main"]
