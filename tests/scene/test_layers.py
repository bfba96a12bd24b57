"""Files of layers: equal layers are equal files, and written layers are read back unchanged."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.layers import CHANNELS, OBJECTS, known_layers, read_layers, write_layers

VALUES = np.arange(2 * 3 * 13, dtype=np.float32).reshape(2, 3, 13)


def test_what_is_written_comes_back(tmp_path: Path) -> None:
    write_layers(tmp_path / "layers.exr", ["normal", "object"], VALUES, '["lamp"]')
    found = read_layers(tmp_path / "layers.exr")
    assert {*found.channels} == {*CHANNELS["normal"], *CHANNELS["object"]}
    np.testing.assert_array_equal(found.channels["N.Y"], VALUES[..., 4])
    np.testing.assert_array_equal(found.channels["id.object"], VALUES[..., 10])
    assert found.attributes == {OBJECTS: '["lamp"]'}


def test_files_have_no_date_of_today(tmp_path: Path) -> None:
    """They are named by their digest, so that equal ones are one."""
    write_layers(tmp_path / "layers.exr", ["depth"], VALUES, "[]")
    assert f"{datetime.now(UTC):%Y:}".encode() not in (tmp_path / "layers.exr").read_bytes()


def test_layers_are_known_by_name_in_one_order() -> None:
    assert known_layers(["object", "albedo", "object"]) == ("albedo", "object")
    with pytest.raises(InputError, match="there is no 'ao'"):
        known_layers(["ao"])
