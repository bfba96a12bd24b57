"""Mitsuba 3 scenes."""
