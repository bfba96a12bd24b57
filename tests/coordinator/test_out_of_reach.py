"""Renders that will not reach the error that they ask for in time: when it is said, and how often."""

import pytest
from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.forecast import Measured, forecast
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.store.data_folder import DataFolder

from tests.coordinator.service import Service, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker

PIXELS = 10_000


def measured(error: float, samples: int = 64, rate: float = 64_000.0, ran: float = 10.0) -> Measured:
    """A render of 10,000 pixels whose workers trace `rate` photons a second, half done."""
    return Measured(
        photons=samples * PIXELS,
        photons_wanted=1e6 * PIXELS,
        mean_samples=samples,
        estimate=ErrorEstimate(
            relative_error=error,
            top_percent_share=0.02,
            effective_pixels=0.5 * PIXELS,
            samples=samples,
            pixels=PIXELS,
            mean=1.0,
            mean_error=0.0,
        ),
        range_ends=[4, 8, 16, 32, 64, 128, 256, 512, 1024, *range(2048, 1_000_001, 1024)],
        photons_per_second=rate,
        cpu_seconds=ran,
        ran_seconds=ran,
    )


def miss(stop: StopConditions, at: Measured, before: bool = False) -> str:
    return forecast(at, stop, 1000.0, before).target_unreachable


def test_it_says_what_will_be_reached_and_what_it_would_take() -> None:
    # 10 s for 64 samples with an error of 8 %: 1 % needs 64 times as many, 640 s.
    stop = StopConditions(relative_error=0.01, wall_seconds=40.0)
    assert miss(stop, measured(0.08)) == (
        "It will have a relative error of about 4 % when it stops after 40 s of running; 1 % was asked "
        "for, which would take 16.0 times as long at this rate."
    )
    until = StopConditions(relative_error=0.01, until=1030.0, until_text="07:00 Europe/Berlin")
    assert "when it stops at 07:00 Europe/Berlin" in miss(until, measured(0.08))
    processor = StopConditions(relative_error=0.01, cpu_seconds=40.0)
    assert "when it has used 40 s of processor time" in miss(processor, measured(0.08))


@pytest.mark.parametrize(
    ("stop", "at"),
    [
        # There is time enough.
        (StopConditions(relative_error=0.01, wall_seconds=700.0), measured(0.08)),
        # Nothing ends it before.
        (StopConditions(relative_error=0.01), measured(0.08)),
        # No error was asked for.
        (StopConditions(wall_seconds=40.0), measured(0.08)),
        # Nothing is known of the error, or of the rate.
        (StopConditions(relative_error=0.01, wall_seconds=40.0), measured(0.0)),
        (StopConditions(relative_error=0.01, wall_seconds=40.0), measured(0.08, rate=0.0)),
        # It has hardly begun.
        (StopConditions(relative_error=0.01, wall_seconds=40.0), measured(0.08, ran=3.0)),
    ],
)
def test_it_is_silent_where_nothing_is_to_be_said(stop: StopConditions, at: Measured) -> None:
    assert miss(stop, at) == ""


def test_a_rate_that_trembles_changes_nothing() -> None:
    """If the predicted time is above the limit by less than a tenth, the earlier statement stays."""
    stop = StopConditions(relative_error=0.01, wall_seconds=610.0)
    assert miss(stop, measured(0.08)) == ""
    assert miss(stop, measured(0.08), before=True) != ""
    plenty = StopConditions(relative_error=0.01, wall_seconds=700.0)
    assert miss(plenty, measured(0.08), before=True) == ""


def test_webhooks_are_told_once(service: Service) -> None:
    folder = service.folder
    folder.webhooks.create("", "https://example.org/")
    service.start()
    asked = StopConditions(relative_error=1e-6, wall_seconds=40.0)
    render = service.create(samples=4_000_000, stop=asked)
    service.work(SimulatedWorker(service.server.url, delay=0.05))
    wait_until(lambda: service.row(render.id).target_unreachable != "")
    assert "0.0001 % was asked for" in service.row(render.id).target_unreachable
    assert told(folder, render.id) == ["target_unreachable"]
    folder.requests.pause(render.id)
    wait_until(lambda: service.row(render.id).target_unreachable == "")
    folder.requests.resume(render.id)
    wait_until(lambda: service.row(render.id).target_unreachable != "")
    # Webhooks know it already; with other conditions it is another promise.
    assert told(folder, render.id) == ["target_unreachable"]
    folder.requests.extend(render.id, 4_000_000, StopConditions(relative_error=1e-6, wall_seconds=50.0))
    wait_until(lambda: len(told(folder, render.id)) == 2)
    folder.requests.cancel(render.id)
    assert service.row(render.id).target_unreachable == ""


def told(folder: DataFolder, render_id: str) -> list[str]:
    rows = folder.database.rows("SELECT event FROM webhook_message WHERE render_id = ?", (render_id,))
    return [str(row["event"]) for row in rows]
