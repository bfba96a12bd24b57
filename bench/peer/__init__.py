"""Comparison with another renderer: the scenes, their translation, its installation and its calls."""
