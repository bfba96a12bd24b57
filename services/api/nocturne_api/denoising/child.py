"""Denoises one image: FILE FOLDER. What is wrong goes to stdout."""

import os
import sys
from pathlib import Path

from nocturne_api.denoising.pictures import write_denoised

CANT = 3
"""Exit code where it can't be done."""


def main() -> None:
    """Does it, at low priority."""
    os.nice(5)
    try:
        write_denoised(Path(sys.argv[1]), Path(sys.argv[2]))
    except ImportError:
        sys.stdout.write("this service has no denoiser; pip install 'nocturne-service[denoise]' brings it")
        sys.exit(CANT)
    except KeyError as missing:
        sys.stdout.write(f"an image without the channel {missing} can't be denoised")
        sys.exit(CANT)


if __name__ == "__main__":
    main()
