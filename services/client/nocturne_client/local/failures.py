"""Errors of the scene language and of files, as errors of this package."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from nocturne_scene.errors import InputError, NocturneError

from nocturne_client.errors import NocturneClientError, Problem


@contextmanager
def client_errors(refused: str | Callable[[InputError], str]) -> Iterator[None]:
    """Raises NocturneClientError instead of them, `refused` with all problems where the input is wrong."""
    try:
        yield
    except InputError as error:
        problems = [Problem(each.place, each.message) for each in error.problems]
        message = refused if isinstance(refused, str) else refused(error)
        raise NocturneClientError(message, problems=problems) from error
    except NocturneError as error:
        raise NocturneClientError(str(error)) from error
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        raise NocturneClientError(f"{where}{error.strerror or error}") from error
