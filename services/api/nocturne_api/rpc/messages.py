"""Views as messages of the public contract."""

from nocturne.v1 import asset_service_pb2, render_service_pb2

from nocturne_api.views import AssetView, RenderView, WorkerView


def render_message(view: RenderView) -> render_service_pb2.Render:
    """A render; the view's fields have the message's names."""
    fields = view.model_dump(exclude={"state", "progress"})
    return render_service_pb2.Render(
        state=render_service_pb2.RenderState.Value(f"RENDER_STATE_{view.state}"),
        progress=render_service_pb2.Progress(**view.progress.model_dump()),
        **fields,
    )


def worker_message(view: WorkerView) -> render_service_pb2.Worker:
    """A worker."""
    return render_service_pb2.Worker(**view.model_dump())


def asset_message(view: AssetView) -> asset_service_pb2.Asset:
    """A stored file."""
    return asset_service_pb2.Asset(**view.model_dump())
