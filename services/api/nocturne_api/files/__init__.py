"""Bytes on their way in and out: open files, uploads, and changed tiles of an image."""
