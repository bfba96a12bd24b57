"""Output for people: images, previews, statistics of how errors are spread."""
