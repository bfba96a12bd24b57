"""Which version this is."""

from importlib.metadata import PackageNotFoundError, version

# As it is installed from its wheel, and as part of the project's development environment.
_DISTRIBUTIONS = ("nocturne", "nocturne-development")


def installed_version() -> str:
    """The version of this package."""
    for name in _DISTRIBUTIONS:
        try:
            return version(name)
        except PackageNotFoundError:
            continue
    return "unknown"
