"""Compiles scenes, cuts renders into jobs, merges partial results, keeps the data folder (the truth)."""

import os

# Previews need one product with a 3 x 3 matrix; threads for it would only take time from the workers.
# Read when numpy is first imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
