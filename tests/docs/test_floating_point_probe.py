"""The C library does not decide bits of images: the tracer calls none of its functions that round freely."""

import re
from pathlib import Path

SOURCES = Path(__file__).parents[2] / "worker" / "src"
OURS = SOURCES / "math"
PROBE = SOURCES / "rounding" / "floating_point_profile.cpp"

# Of <cmath>, without those that IEEE 754 fixes to the last bit (sqrt, fma, floor, ...) or that are exact.
_FREE = (
    "sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|expm1|log|log2|log10|log1p|"
    "pow|cbrt|hypot|erf|erfc|tgamma|lgamma"
)
_CALL = re.compile(rf"(\w*::|(?<![\w:.>]))({_FREE})f?\(|using std::(?:{_FREE})\b")


def _calls(path: Path) -> set[tuple[str, str]]:
    """Of each such call the namespace and the function."""
    code = re.sub(r"//.*|\"[^\"]*\"", "", path.read_text(encoding="utf-8"))
    return {(found[1] or "", found[2] or "") for found in _CALL.finditer(code)}


def test_functions_are_our_own_and_the_probe_asks_all_of_them() -> None:
    sources = [path for path in SOURCES.rglob("*") if path.suffix in (".h", ".cpp")]
    used: set[str] = set()
    for path in sources:
        if OURS in path.parents:
            continue
        calls = _calls(path)
        assert {namespace for namespace, _ in calls} <= {"math::"}, f"{path}: {calls}"
        used |= {name for _, name in calls if path != PROBE}
    assert {"exp", "sin", "atan2"} <= used
    assert {name for _, name in _calls(PROBE)} == used


def test_other_functions_would_be_found(tmp_path: Path) -> None:
    for line in ("y = std::exp(x);", "y = expf(x);", "using std::log;", "return ::sin(x);"):
        file = tmp_path / "a.cpp"
        file.write_text(line)
        assert {namespace for namespace, _ in _calls(file)} != {"math::"}, line
        assert _calls(file), line
