"""Published numbers as files, each with its source inside."""
