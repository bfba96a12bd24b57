"""Client of the Nocturne render service.

from nocturne_client import Client

with Client() as client:
    render = client.submit(Path("scene.json"), width=640, height=480, samples=256)
    for state in client.watch(render.id):
        print(state.fraction)
    client.download(render.id, "exr", Path("image.exr"))
"""

from nocturne_client.client import Client
from nocturne_client.contract import Progress, StopConditions, Worker
from nocturne_client.errors import NocturneClientError, NotReachedError, Problem
from nocturne_client.models import Render

__all__ = [
    "Client",
    "NocturneClientError",
    "NotReachedError",
    "Problem",
    "Progress",
    "Render",
    "StopConditions",
    "Worker",
]
