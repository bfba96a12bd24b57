"""A folder for Unix sockets that other users can't enter."""

import os
import tempfile

_MAX_BYTES = 107
"""Of a socket's address: sun_path in unix(7), less the end of the text."""
_LONGEST = "/nocturne-12345678/coordinator.sock"
_SHORT = "/tmp"  # noqa: S108 - a folder of mode 0700 is made in it


def socket_folder() -> tempfile.TemporaryDirectory[str]:
    """In the folder for temporary files, or below /tmp where paths in there are too long for a socket's."""
    is_long = len(os.fsencode(tempfile.gettempdir() + _LONGEST)) > _MAX_BYTES
    return tempfile.TemporaryDirectory(
        prefix="nocturne-", dir=_SHORT if is_long else None, ignore_cleanup_errors=True
    )
