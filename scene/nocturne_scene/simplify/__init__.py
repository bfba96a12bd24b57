"""What a scene needs: its document with one part less, what that does to the image, what is cheapest."""
