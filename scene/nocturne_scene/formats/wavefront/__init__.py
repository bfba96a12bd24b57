"""Scenes of Wavefront OBJ files."""
