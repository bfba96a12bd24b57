"""The page of `nocturne validate`: one HTML file that needs no other."""

from collections.abc import Iterator
from html import escape

from nocturne_scene.validation.suites import SUITES
from nocturne_scene.validation.verdict import Reading, Verdict, verdict

from nocturne_client.local.validating import Validation

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; max-width: 68rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; width: 100%; font-size: 0.87rem; margin: 0.5rem 0 1.5rem; }
th, td { text-align: left; padding: 0.15rem 0.6rem 0.15rem 0; border-bottom: 1px solid #8884; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.off td { background: #e5484d33; }
.source { color: #777; }
:root { color-scheme: light dark; }
circle { fill: #3b82c4; fill-opacity: 0.55; }
line { stroke: #888; stroke-width: 0.5; }
text { fill: currentColor; font-size: 11px; }
"""


def page(found: Validation) -> str:
    """HTML, UTF-8."""
    whole = found.verdict
    parts = [suite for suite in SUITES if found.of(suite.name)]
    body = [
        "<h1>Nocturne: validation</h1>",
        f"<p>Engine {found.engine}; {escape(found.machine)}; {found.when:%Y-%m-%d %H:%M} UTC; "
        f"{found.seconds:.0f} s; seed {found.seed}{'; a part of each suite' if found.quick else ''}.</p>",
        f"<p><strong>{escape(sentence(whole))}</strong></p>",
        "<p>z is the deviation from the truth in standard errors as the engine tells them. Bounds hold with "
        "99 % if the engine is right. Samples are independent ones.</p>",
        *(_strip(suite.about, found.of(suite.name), whole.bound) for suite in parts),
    ]
    for suite in parts:
        readings = found.of(suite.name)
        body += [
            f"<h2>{escape(suite.about)}</h2>",
            f"<p>{escape(sentence(verdict(readings)))}</p>",
            "<table><tr><th>value</th><th class=number>truth</th><th class=number>read, 95 %</th>"
            "<th class=number>z</th><th>source of the truth</th></tr>",
            *_rows(readings, whole.bound),
            "</table>",
        ]
    return (
        "<!doctype html><html lang=en><head><meta charset=utf-8><title>Nocturne: validation</title>"
        f"<style>{_STYLE}</style></head><body>{''.join(body)}</body></html>\n"
    )


def sentence(found: Verdict) -> str:
    """What many readings say."""
    noisy = found.values - found.exact - found.wrong
    told = f"{found.values} values"
    if found.exact or found.wrong:
        told += f", {found.exact} of them right to rounding without noise"
    if found.wrong:
        told += f" and {found.wrong} wrong"
    if noisy > 1:
        told += (
            f": mean z {found.mean:+.3f} (bound {found.mean_bound:.3f}), standard deviation "
            f"{found.deviation:.3f} (1 +- {found.deviation_bound:.3f}), largest |z| {found.largest:.2f} "
            f"(bound {found.bound:.2f}), {100.0 * found.inside:.1f} % of the 95 % intervals hold the truth"
        )
    return told + ("." if found.is_good else ": chance does not explain this.")


def _rows(readings: list[Reading], bound: float) -> Iterator[str]:
    before = ""
    for each in readings:
        z, source = each.z, each.value.source
        off = abs(z) > bound if z is not None else not each.is_exact
        yield (
            f"<tr{' class=off' if off else ''}><td>{escape(each.value.name)}</td>"
            f"<td class=number>{each.value.truth:.6g}</td>"
            f"<td class=number>{each.found:.6g} &plusmn; {each.half_interval:.1g}</td>"
            f"<td class=number>{'exact' if z is None else f'{z:+.2f}'}</td>"
            f"<td class=source>{escape(source) if source != before else '&#8243;'}</td></tr>"
        )
        before = source


def _strip(name: str, readings: list[Reading], bound: float) -> str:
    """A dot for each z, from -5 to 5; lines at 0, 2 standard errors and the bound."""

    def place(z: float) -> float:
        return 300.0 + 40.0 * max(-5.0, min(5.0, z))

    lines = "".join(
        f'<line x1="{place(z):.1f}" x2="{place(z):.1f}" y1="2" y2="24"/>' for z in (-bound, -2, 0, 2, bound)
    )
    dots = "".join(
        f'<circle cx="{place(each.z):.1f}" cy="{8 + 5 * (index % 3)}" r="2.4"/>'
        for index, each in enumerate(readings)
        if each.z is not None
    )
    return (
        f'<svg width="820" height="26" role="img" aria-label="z of {escape(name)}">{lines}{dots}'
        f'<text x="515" y="17">{escape(name)}</text></svg>'
    )
