"""Scene documents (what people write) and their compilation to what the tracer reads."""
