"""Work of an API process other than answering calls."""
