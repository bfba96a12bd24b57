"""What a pilot learned of the light of a scene, at single places."""
