"""Scenes of Radiance."""
