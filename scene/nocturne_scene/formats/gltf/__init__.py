"""glTF 2.0 scenes."""
