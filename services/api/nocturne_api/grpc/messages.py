"""Models of the REST contract as messages of the gRPC contract, field by field of the same name."""

from nocturne.v1 import asset_service_pb2, render_service_pb2

from nocturne_api.models.assets import Asset
from nocturne_api.models.renders import Convergence, Reading, Render
from nocturne_api.models.webhooks import Webhook
from nocturne_api.models.workers import Worker


def render_message(model: Render) -> render_service_pb2.Render:
    """A render; the model's fields have the message's names."""
    fields = model.model_dump(exclude={"state", "progress", "stop", "look_first"})
    region = None if model.look_first is None else render_service_pb2.Region(**model.look_first.model_dump())
    return render_service_pb2.Render(
        state=render_service_pb2.RenderState.Value(f"RENDER_STATE_{model.state}"),
        progress=render_service_pb2.Progress(**model.progress.model_dump()),
        stop=render_service_pb2.StopConditions(**model.stop.model_dump()),
        look_first=region,
        **fields,
    )


def convergence_message(model: Convergence) -> render_service_pb2.GetConvergenceResponse:
    """The error's history."""
    points = [render_service_pb2.ConvergencePoint(**point.model_dump()) for point in model.points]
    return render_service_pb2.GetConvergenceResponse(points=points)


def reading_message(model: Reading) -> render_service_pb2.Reading:
    """Numbers of a region."""
    values = [render_service_pb2.ReadValue(**each.model_dump()) for each in model.values]
    region = render_service_pb2.Region(**model.region.model_dump())
    return render_service_pb2.Reading(
        region=region, values=values, **model.model_dump(exclude={"region", "values"})
    )


def asked_stop(message: render_service_pb2.StopConditions) -> dict[str, float | str]:
    """What a caller asks for, by name; what is 0 or empty is not asked for."""
    return {field.name: value for field, value in message.ListFields() if field.name != "until_time"}


def worker_message(model: Worker) -> render_service_pb2.Worker:
    """A worker."""
    return render_service_pb2.Worker(**model.model_dump())


def webhook_message(model: Webhook) -> render_service_pb2.Webhook:
    """A webhook, with its secret where the model has it."""
    return render_service_pb2.Webhook(**model.model_dump())


def asset_message(model: Asset) -> asset_service_pb2.Asset:
    """A stored file."""
    return asset_service_pb2.Asset(**model.model_dump())
