"""Views as messages of the public contract."""

from nocturne.v1 import asset_service_pb2, render_service_pb2

from nocturne_api.views import AssetView, ConvergenceView, RenderView, WebhookView, WorkerView


def render_message(view: RenderView) -> render_service_pb2.Render:
    """A render; the view's fields have the message's names."""
    fields = view.model_dump(exclude={"state", "progress", "stop", "look_first"})
    region = None if view.look_first is None else render_service_pb2.Region(**view.look_first.model_dump())
    return render_service_pb2.Render(
        state=render_service_pb2.RenderState.Value(f"RENDER_STATE_{view.state}"),
        progress=render_service_pb2.Progress(**view.progress.model_dump()),
        stop=render_service_pb2.StopConditions(**view.stop.model_dump()),
        look_first=region,
        **fields,
    )


def convergence_message(view: ConvergenceView) -> render_service_pb2.GetConvergenceResponse:
    """The error's history."""
    points = [render_service_pb2.ConvergencePoint(**point.model_dump()) for point in view.points]
    return render_service_pb2.GetConvergenceResponse(points=points)


def asked_stop(message: render_service_pb2.StopConditions) -> dict[str, float | str]:
    """What a caller asks for, by name; what is 0 or empty is not asked for."""
    return {field.name: value for field, value in message.ListFields() if field.name != "until_time"}


def worker_message(view: WorkerView) -> render_service_pb2.Worker:
    """A worker."""
    return render_service_pb2.Worker(**view.model_dump())


def webhook_message(view: WebhookView) -> render_service_pb2.Webhook:
    """A webhook, with its secret where the view has it."""
    return render_service_pb2.Webhook(**view.model_dump())


def asset_message(view: AssetView) -> asset_service_pb2.Asset:
    """A stored file."""
    return asset_service_pb2.Asset(**view.model_dump())
