"""What a report says: checks of a requirement, tables and plans. Every +- is half of a 95 % interval."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from nocturne_scene.photometry.requirements import Certainty, Verdict

from nocturne_client.local.report.drawing import Drawing
from nocturne_client.readings import CONFIDENCE, rounded

INTERVALS = (
    "Every ± is half of a 95 % interval of the render's noise. It knows nothing of how true the scene is."
)


@dataclass(frozen=True)
class Check:
    """One limit of a requirement."""

    what: str
    limit: str
    found: str
    certainty: Certainty | None
    """None: not measured."""

    @property
    def verdict(self) -> Verdict | None:
        """None: not measured."""
        return None if self.certainty is None else self.certainty.verdict

    @property
    def says(self) -> str:
        """The verdict with its probability."""
        if self.certainty is None:
            return "not measured"
        words = {"holds": "holds", "fails": "does not hold"}
        if self.certainty.verdict in words:
            sure = self.certainty.holds if self.certainty.verdict == "holds" else self.certainty.fails
            return f"{words[self.certainty.verdict]}, {percent(sure)}"
        return f"open, {100.0 * self.certainty.holds:.0f} % that it holds"


@dataclass(frozen=True)
class Table:
    """Rows of text below a head; columns but the first `texts` are numbers, to the right."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    texts: int = 1


@dataclass
class Section:
    """Of a report, in the order: paragraphs, drawings, tables, notes."""

    title: str
    paragraphs: list[str] = field(default_factory=list)
    drawings: list[Drawing] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass
class Report:
    """All of it."""

    title: str
    facts: list[str]
    """Lines below the title."""
    requirement: str = ""
    checks: list[Check] = field(default_factory=list)
    whole: Certainty | None = None
    """Of all checks that were measured."""
    warnings: list[str] = field(default_factory=list)
    """Why numbers are not to be relied on."""
    sections: list[Section] = field(default_factory=list)

    @property
    def verdict(self) -> str:
        """A sentence; empty without a requirement."""
        if not self.requirement or self.whole is None:
            return ""
        missing = [each.what for each in self.checks if each.certainty is None]
        rest = f" Not measured: {', '.join(missing)}." if missing else ""
        if self.whole.verdict == "holds":
            measured = "all that was measured holds" if missing else "it holds"
            return f"{self.requirement}: {measured}, with {percent(self.whole.holds)}.{rest}"
        if self.whole.verdict == "fails":
            failed = [each.what for each in self.checks if each.verdict == "fails"]
            return f"{self.requirement}: it does not hold: {', '.join(failed)}.{rest}"
        return f"{self.requirement}: open; more samples decide.{rest}"


def percent(part: float) -> str:
    """Never 100 %, which chance has not."""
    return "more than 99.9 %" if part > 0.999 else f"at least {100.0 * part:.1f} %"


def with_half(value: float | None, error: float | None, digits: int = 4) -> str:
    """A value with half of its 95 % interval, from its standard error."""
    if value is None or value != value:
        return "-"
    if error is None or error != error:
        return rounded(value, digits)
    if error <= 0.0:
        return rounded(value, digits)
    half = float(f"{CONFIDENCE * error:.2g}")
    # As many decimals as the interval has.
    decimals = max(0, len(f"{half:.10f}".rstrip("0").partition(".")[2]))
    return f"{value:.{decimals}f} ± {half:g}"


def between(value: float, low: float, high: float, decimals: int) -> str:
    """A value with an interval whose halves differ."""
    return f"{value:.{decimals}f} ({low:.{decimals}f} to {high:.{decimals}f})"
