"""The terminal: results on standard output; errors, and how far work is, on standard error."""

from rich.console import Console

CONSOLE = Console(highlight=False)
ERRORS = Console(stderr=True, highlight=False)
