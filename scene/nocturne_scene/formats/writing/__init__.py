"""Scene documents, made into scenes of other renderers: one package for each format."""
