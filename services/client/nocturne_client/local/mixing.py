"""`nocturne mix`: the image of other amounts of light in its light groups."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from nocturne_coordinator.output.mixes import write_mix
from nocturne_scene.errors import InputError

from nocturne_client.errors import NocturneClientError
from nocturne_client.outputs import check_output, put


def mix_file(image: Path, output: Path, factors: Mapping[str, float]) -> None:
    """Writes the EXR; `output` is whole or untouched. Raises NocturneClientError."""
    check_output(output)
    try:
        with tempfile.TemporaryDirectory(prefix="nocturne-mix-") as folder:
            made = Path(folder) / "mix.exr"
            write_mix(image, made, factors)
            put(made, output)
    except InputError as error:
        raise NocturneClientError(f"{error.problems[0].place}: {error.problems[0].message}") from error
    except OSError as error:
        raise NocturneClientError(f"{output}: {error}") from error
