"""Another renderer beside ours: the scenes, their translation, and how it is installed and asked."""
