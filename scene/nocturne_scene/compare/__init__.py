"""Whether two images are the same but for their noise: statistics, and image files."""
