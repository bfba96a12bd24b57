"""Compiles scenes, cuts renders into jobs, merges partial results, keeps the data folder (the truth)."""
