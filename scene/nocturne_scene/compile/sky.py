"""Whether a compiled scene has light from infinitely far away."""

from nocturne.v1 import scene_pb2


def has_sky(scene: scene_pb2.CompiledScene) -> bool:
    """An environment, or discs such as the Sun's."""
    return scene.HasField("environment") or bool(scene.distant_discs)
