"""What the readers of other renderers' scenes share."""
