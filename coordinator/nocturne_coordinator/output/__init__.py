"""What people look at: images, previews, statistics of how errors are spread."""
