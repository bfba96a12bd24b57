"""What tests of several folders share."""

from collections.abc import Iterator

import pytest

from tests.system.up import Up


@pytest.fixture(scope="module")
def running_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Up]:
    """`nocturne up` with one worker of two threads, on free ports and with a data folder of its own."""
    with Up(tmp_path_factory.mktemp("up")) as service:
        yield service
