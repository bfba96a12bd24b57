"""Scene documents, as people write them, and their compilation for the tracer."""
