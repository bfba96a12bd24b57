"""A report as one HTML file that needs no other, and prints as it is."""

from collections.abc import Iterator, Sequence
from html import escape

from nocturne_client.local.report.contents import Check, Report, Section, Table
from nocturne_client.local.report.drawing import svg

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #1b1b1b; background: #fff;
  max-width: 56rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; margin: 0 0 .3rem; } h2 { font-size: 1.2rem; margin: 2rem 0 .4rem; }
.facts, .note { color: #555; font-size: .85rem; margin: .15rem 0; }
.verdict { font-size: 1.05rem; font-weight: 600; padding: .6rem .8rem; margin: 1rem 0;
  border-left: .4rem solid #888; }
.holds { border-color: #2b8a3e; } .fails { border-color: #c92a2a; } .open { border-color: #e8a100; }
.warning { border-left: .4rem solid #c92a2a; padding: .3rem .8rem; margin: .5rem 0; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: .85rem; margin: .5rem 0; }
th, td { text-align: left; padding: .2rem .7rem .2rem 0; border-bottom: 1px solid #ccc; vertical-align: top; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td:not(.number) { overflow-wrap: anywhere; min-width: 4.5rem; }
svg { display: block; max-width: 100%; height: auto; }
@media print {
  @page { size: A4; margin: 15mm; }
  body { max-width: none; margin: 0; padding: 0; font-size: 10pt; }
  h2 { break-after: avoid; } table, svg, .verdict { break-inside: avoid; } .wide { overflow: visible; }
  table { font-size: 7.5pt; } th, td { padding-right: .35rem; }
}
"""


def html(report: Report) -> str:
    """HTML, UTF-8."""
    parts = [f"<h1>{escape(report.title)}</h1>"]
    parts += [f"<p class=facts>{escape(line)}</p>" for line in report.facts]
    parts += [f"<p class=warning>{escape(line)}</p>" for line in report.warnings]
    if report.verdict and report.whole is not None:
        parts.append(f'<p class="verdict {report.whole.verdict}">{escape(report.verdict)}</p>')
    if report.checks:
        parts += [*_table(checks_table(report.checks))]
    for section in report.sections:
        parts += _section(section)
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>{escape(report.title)}</title><style>{_STYLE}</style></head>"
        f"<body>{''.join(parts)}</body></html>\n"
    )


def checks_table(checks: list[Check]) -> Table:
    """A row for each limit."""
    rows = [(each.what, each.limit, each.found, each.says) for each in checks]
    return Table(("required", "limit", "found, 95 %", "verdict"), rows, texts=4)


def _section(section: Section) -> Iterator[str]:
    yield f"<h2>{escape(section.title)}</h2>"
    for paragraph in section.paragraphs:
        yield f"<p>{escape(paragraph)}</p>"
    for drawing in section.drawings:
        yield svg(drawing, alone=False)
    for table in section.tables:
        yield from _table(table)
    for note in section.notes:
        yield f"<p class=note>{escape(note)}</p>"


def _table(table: Table) -> Iterator[str]:
    def cells(row: Sequence[str], tag: str) -> str:
        return "".join(
            f"<{tag}{'' if at < table.texts else ' class=number'}>{escape(text)}</{tag}>"
            for at, text in enumerate(row)
        )

    yield '<div class=wide tabindex=0 role=region aria-label="table"><table>'
    if any(table.head):
        yield f"<tr>{cells(table.head, 'th')}</tr>"
    for row in table.rows:
        yield f"<tr>{cells(row, 'td')}</tr>"
    yield "</table></div>"
