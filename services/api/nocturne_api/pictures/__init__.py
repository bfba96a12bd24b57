"""Image files from elsewhere, as tiles for viewers."""
