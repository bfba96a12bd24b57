"""What a scene needs for a target error, and the cheapest model that meets it."""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.ranges import make_schedule
from nocturne_scene.simplify.candidates import candidates
from nocturne_scene.simplify.choosing import Model, can_join, promising, saving, worth_more
from nocturne_scene.simplify.pilot import RENDERS, Parts, Pilot
from nocturne_scene.simplify.simplification import Document, Simplification
from nocturne_scene.simplify.statistics import FEW, resolvable

CONFIDENCE = 0.95
"""Of reported intervals, and that the chosen model meets the target."""

_FIRST_SAMPLES = 16
_MAX_SAMPLES = 2**16
# Models that are tried with several simplifications at once, and that are confirmed.
_TRIES = 6

Say = Callable[[str, int], Callable[[], None]]
"""Called with the name of a task and the number of its steps; returns a function to call after each step."""


@dataclass(frozen=True)
class Request:
    """What a preflight is asked."""

    error: float
    """Total relative error that is wanted, in (0, 1)."""
    width: int
    height: int
    """Film of the real render, pixels."""
    pilot_edge: int
    """Longer edge of the pilot's film, pixels."""
    budget_s: float
    """Processor time for the pilot, about."""
    threads: int


@dataclass(frozen=True)
class Preflight:
    """The results."""

    request: Request
    film: tuple[int, int]
    """Of the pilot."""
    samples: int
    """Of each of its renders."""
    cpu_s: float
    """Processor time of the search."""
    full: Model
    models: list[Model]
    """Each with one simplification."""
    chosen: Model
    """Measured again with new seeds; the full model if nothing simpler is known to do, or `rare`."""
    document: Document
    """Of the chosen model, files by digest."""
    without_effect: list[str]
    """Simplifications that leave the same compiled scene, or none."""
    effective_pixels: float
    """That carry the full model's noise in the pilot."""
    rare: bool
    """Whether these are so few that nothing is to be trusted."""
    wanted_s: float
    """Processor time of a pilot that sees biases of half of the target; 0 if this one does."""

    @property
    def pixels(self) -> int:
        """Of the real film."""
        return self.request.width * self.request.height

    @property
    def saving(self) -> float:
        """The full model's time to the target over the chosen one's."""
        return saving(self.full, self.chosen, self.request.error)


def run_preflight(request: Request, document: Document, folder: Path, say: Say) -> Preflight:
    """Run the pilot of a scene document. `folder` holds the scene's files in `blobs`, and takes the results.

    Raises InputError and PilotFailed.
    """
    # A wrong film is reported before the work.
    make_schedule(request.width, request.height, 1)
    return _Search(request, document, folder, say).run()


def pilot_film(width: int, height: int, edge: int) -> tuple[int, int]:
    """Width and height of the same shape, the longer one `edge` at most."""
    scale = min(1.0, edge / max(width, height))
    return max(1, round(scale * width)), max(1, round(scale * height))


class _Search:
    """One pilot: all simplifications alone, then several at once, then the chosen ones once more."""

    def __init__(self, request: Request, document: Document, folder: Path, say: Say) -> None:
        self._request, self._say = request, say
        self._film = pilot_film(request.width, request.height, request.pilot_edge)
        self._pilot = Pilot(document, folder, self._film, request.threads)
        self._document = document
        self._samples = _FIRST_SAMPLES

    def run(self) -> Preflight:
        full_scene = self._pilot.compiled(())
        found: list[Simplification] = []
        without_effect: list[Simplification] = []
        for each in candidates(self._document, self._pilot.find):
            try:
                same = self._pilot.compiled((each,)) == full_scene
            except InputError:
                same = True
            (without_effect if same else found).append(each)
        wanted_s = self._choose_samples(len(found))
        full, models, carriers = self._measure("each part alone", [(each,) for each in found], CONFIDENCE)
        # What few photons decide is not to be chosen by.
        rare = carriers < min(FEW, 0.5 * self._pilot.pixels)
        chosen = full if rare else self._confirmed(self._joined(full, models), full)
        return Preflight(
            self._request,
            self._film,
            self._samples,
            self._pilot.cpu_s,
            full,
            models,
            chosen,
            self._pilot.document(chosen.parts),
            [each.name for each in without_effect],
            carriers,
            rare,
            wanted_s,
        )

    def _choose_samples(self, models: int) -> float:
        """As many as show biases of half of the target, or as the budget allows; where that is fewer, the
        processor time that would do, else 0.

        They are chosen by renders whose photons are not used again.
        """
        full, _, _ = self._measure("how noisy it is", [], CONFIDENCE)
        seen = resolvable(full.noise / _FIRST_SAMPLES, RENDERS, self._pilot.pixels, CONFIDENCE)
        # The visible bias goes as the root of the noise, so as one over the root of the samples.
        wanted = _FIRST_SAMPLES * (seen / (self._request.error / 2)) ** 2
        # A half more than the models alone take: for several simplifications at once, and for confirmation.
        per_sample = 1.5 * RENDERS * (models + 1) * full.seconds * self._pilot.pixels
        affordable = self._request.budget_s / per_sample
        self._samples = max(_FIRST_SAMPLES, int(min(wanted + 1, affordable, _MAX_SAMPLES)))
        return per_sample * wanted if self._samples < wanted else 0.0

    def _measure(self, what: str, models: list[Parts], confidence: float) -> tuple[Model, list[Model], float]:
        step = self._say(what, RENDERS * (len(models) + 1))
        return self._pilot.measure(models, self._samples, confidence, step)

    def _joined(self, full: Model, models: list[Model]) -> list[Model]:
        """Models of more and more simplifications, each clearly faster than the one before."""
        steps: list[Model] = []
        tries = 0
        for each in promising(models, full, self._request.error):
            part: Simplification = each.parts[0]
            if not steps:
                steps.append(each)
            elif tries < _TRIES and can_join(steps[-1].parts, part):
                tries += 1
                parts = (*steps[-1].parts, part)
                try:
                    _, measured, _ = self._measure(f"{len(parts)} at once", [parts], CONFIDENCE)
                except InputError:
                    continue
                if worth_more(measured[0], steps[-1], self._request.error):
                    steps.append(measured[0])
        return steps

    def _confirmed(self, steps: list[Model], full: Model) -> Model:
        """The last of the models that meets the target with new seeds too.

        Which were tried was decided by measuring; this was not, so chance that helped there does not help
        here. Each of several attempts gets its part of the chance of error.
        """
        confidence = 1 - (1 - CONFIDENCE) / max(1, len(steps))
        for model in reversed(steps):
            measured = self._measure("once more", [model.parts], confidence)[1][0]
            if isfinite(measured.samples_for(self._request.error)) and worth_more(
                measured, full, self._request.error
            ):
                return measured
        return full
