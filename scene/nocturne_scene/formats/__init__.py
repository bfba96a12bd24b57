"""Scenes of other renderers, made into scene documents: one package for each format."""
