"""Random scenes by methods that share little: sixty, or two hundred in `make accuracy`.

`make crossings` traces a thousand.
False alarms: 1 % for all together. Seeds are fixed.
"""

import pytest

from tests.accuracy.tracing import IN_FULL
from tests.crossings.campaign import ENOUGH, Campaign, run, told

pytestmark = pytest.mark.system

_SCENES = 200 if IN_FULL else 60
_SAMPLES = 16
_PILOTS = 4


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    folder = tmp_path_factory.mktemp("crossings")
    return run(range(_SCENES), folder, samples=_SAMPLES, pilots=_PILOTS)


def test_methods_agree(found: Campaign) -> None:
    assert not found.faults, "\n".join(map(told, found.faults))


def test_stated_errors_hold(found: Campaign) -> None:
    assert found.coverage >= ENOUGH, found.summary()
