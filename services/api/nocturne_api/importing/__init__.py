"""Scenes of other renderers are imported in child processes with bounded time, memory and size."""
