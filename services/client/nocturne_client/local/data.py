"""Where data are kept unless somebody says otherwise."""

from pathlib import Path

import platformdirs


def default_data_folder() -> Path:
    """The user's own: ~/.local/share/nocturne, or what XDG_DATA_HOME says."""
    return platformdirs.user_data_path("nocturne")
