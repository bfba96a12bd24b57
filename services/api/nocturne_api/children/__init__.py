"""Throw-away child processes for work that needs bounds of time and memory: one program for each kind."""
