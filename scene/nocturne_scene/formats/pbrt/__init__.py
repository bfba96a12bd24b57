"""pbrt-v4 scenes."""
