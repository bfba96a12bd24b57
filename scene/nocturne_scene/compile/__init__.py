"""From a checked scene document to the messages that the tracer reads."""
