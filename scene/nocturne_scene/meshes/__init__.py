"""Meshes: reading files within bounds, simple shapes as triangles, packing."""
