"""Scenes of other renderers that nobody here wrote: where they are, and how many of them are imported."""
