"""A scene's needs: its document with one part less, the effect on the image, the cheapest model."""
