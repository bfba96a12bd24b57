"""The floating-point profile is a digest of what all functions give whose last bit is the C library's
choice."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROBE = ROOT / "worker" / "src" / "rounding" / "floating_point_profile.cpp"

# Of <cmath>, without those that IEEE 754 fixes to the last bit (sqrt, fma, floor, ...) or that are exact.
_FREE = (
    "sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|expm1|log|log2|log10|log1p|"
    "pow|cbrt|hypot|erf|erfc|tgamma|lgamma"
)
_CALL = re.compile(rf"\bstd::({_FREE})\(")


def _called(path: Path) -> set[str]:
    return set(_CALL.findall(path.read_text(encoding="utf-8")))


def test_the_probe_asks_every_function_that_the_tracer_uses() -> None:
    sources = [path for path in (ROOT / "worker" / "src").rglob("*") if path.suffix in (".h", ".cpp")]
    used = set().union(*(_called(path) for path in sources if path != PROBE))
    assert {"exp", "sin", "atan2"} <= used
    assert _called(PROBE) == used


def test_no_function_is_called_by_another_name() -> None:
    """As `using std::exp` or from <math.h>, where the test above would miss it."""
    bare = re.compile(rf"(?<![\w:.>])(?:{_FREE})f?\(|using std::(?:{_FREE})\b")
    for path in (ROOT / "worker" / "src").rglob("*.[hc]*"):
        if path.suffix in (".h", ".cpp"):
            code = re.sub(r"//.*|\"[^\"]*\"", "", path.read_text(encoding="utf-8"))
            assert not bare.search(code), f"{path}: {bare.search(code)}"
