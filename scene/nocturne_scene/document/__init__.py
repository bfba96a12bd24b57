"""The scene document: its schema, one module for each part, and the checks that need the whole of it."""
