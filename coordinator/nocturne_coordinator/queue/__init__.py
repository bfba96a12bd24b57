"""Redis streams: jobs out, results in. The only Redis user in Python."""
