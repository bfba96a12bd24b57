"""`python -m nocturne_client` is `nocturne`."""

from nocturne_client.cli.app import main

main()
