"""Image files: textures and environment maps."""
