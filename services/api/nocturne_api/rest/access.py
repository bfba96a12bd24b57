"""How routers get at the operations."""

from typing import Annotated

from fastapi import Depends, Request

from nocturne_api.operations.operations import Operations


def _operations(request: Request) -> Operations:
    operations: Operations = request.app.state.operations
    return operations


Service = Annotated[Operations, Depends(_operations)]
