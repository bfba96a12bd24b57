"""Reports of finished renders."""
