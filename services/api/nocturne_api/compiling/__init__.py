"""Scenes are compiled in child processes with bounded time and memory."""
