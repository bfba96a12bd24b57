"""A report as PDF, on A4, by ReportLab."""

import io
from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape

from reportlab.lib import colors
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import BaseDocTemplate, Flowable, Frame, KeepTogether, PageTemplate, Paragraph, Spacer
from reportlab.platypus import Table as PdfTable

from nocturne_client.local.report.contents import Report, Section, Table
from nocturne_client.local.report.drawing import Area, Drawing, Line, Point, Text, letters
from nocturne_client.local.report.html import checks_table

_FONT, _BOLD = "Vera", "VeraBold"
_MARGIN = 20 * mm
_WIDTH = A4[0] - 2 * _MARGIN
_INK, _GREY = colors.HexColor("#1b1b1b"), colors.HexColor("#555555")
_SIDES = {"holds": "#2b8a3e", "fails": "#c92a2a", "open": "#e8a100"}


def pdf(report: Report) -> bytes:
    """PDF 1.4, its letters inside. Equal reports give equal bytes."""
    for name, bold in ((_FONT, False), (_BOLD, True)):
        pdfmetrics.registerFont(TTFont(name, str(letters(bold=bold))))
    pdfmetrics.registerFontFamily(_FONT, normal=_FONT, bold=_BOLD, italic=_FONT, boldItalic=_BOLD)
    made = io.BytesIO()
    document = BaseDocTemplate(
        made,
        pagesize=A4,
        title=report.title,
        author="",
        subject=report.requirement,
        creator="Nocturne",
        invariant=1,
        lang="en",
    )
    frame = Frame(_MARGIN, _MARGIN, _WIDTH, A4[1] - 2 * _MARGIN, 0, 0, 0, 0)
    document.addPageTemplates(
        PageTemplate("page", [frame], onPage=lambda canvas, page: _foot(canvas, report.title, page.page))
    )
    document.build(list(_story(report)))
    return made.getvalue()


def _style(size: float, **more: object) -> ParagraphStyle:
    given = {"fontName": _FONT, "fontSize": size, "leading": 1.35 * size, "textColor": _INK, **more}
    return ParagraphStyle(f"of {size}", **given)


def _story(report: Report) -> Iterator[Flowable]:
    yield Paragraph(escape(report.title), _style(18, fontName=_BOLD, spaceAfter=4))
    for line in report.facts:
        yield Paragraph(escape(line), _style(8, textColor=_GREY))
    for line in report.warnings:
        yield _beside(line, "#c92a2a", 8.5)
    if report.verdict and report.whole is not None:
        yield _beside(report.verdict, _SIDES[report.whole.verdict], 10.5)
    if report.checks:
        yield _table(checks_table(report.checks))
    for section in report.sections:
        yield from _section(section)


def _beside(text: str, colour: str, size: float) -> Flowable:
    """A paragraph with a bar of a colour at its left."""
    inner = Paragraph(f"<b>{escape(text)}</b>", _style(size))
    style = [("LINEBEFORE", (0, 0), (0, 0), 3, colors.HexColor(colour)), ("LEFTPADDING", (0, 0), (0, 0), 8)]
    return PdfTable([[inner]], colWidths=[_WIDTH], style=style, spaceBefore=6, spaceAfter=6)


def _section(section: Section) -> Iterator[Flowable]:
    head: list[Flowable] = [
        Spacer(1, 10),
        Paragraph(escape(section.title), _style(12, fontName=_BOLD, spaceAfter=4)),
    ]
    parts: list[Flowable] = [Paragraph(escape(each), _style(9)) for each in section.paragraphs if each]
    parts += [_Drawn(each) for each in section.drawings]
    parts += [_table(each) for each in section.tables]
    # A title stays with the first part below it.
    yield KeepTogether([*head, *parts[:1]])
    yield from parts[1:]
    for note in section.notes:
        yield Paragraph(escape(note), _style(7.5, textColor=_GREY, spaceBefore=2))


def _table(table: Table) -> Flowable:
    size = 8.0 if len(table.head) <= 6 else 6.8
    left, right = _style(size), _style(size, alignment=2)
    bold = [_style(size, fontName=_BOLD), _style(size, fontName=_BOLD, alignment=2)]

    def row(cells: Sequence[str], styles: list[ParagraphStyle]) -> list[Paragraph]:
        together = (escape(text.replace(" ± ", "\u00a0±\u00a0")) for text in cells)
        return [Paragraph(text, styles[int(at >= table.texts)]) for at, text in enumerate(together)]

    rows = [row(table.head, bold)] if any(table.head) else []
    rows += [row(each, [left, right]) for each in table.rows]
    style = [
        ("LINEBELOW", (0, 0), (-1, -1), 0.3, colors.HexColor("#cccccc")),
        ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ("LEFTPADDING", (0, 0), (-1, -1), 2),
        ("RIGHTPADDING", (0, 0), (-1, -1), 4),
        ("TOPPADDING", (0, 0), (-1, -1), 2),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 2),
    ]
    return PdfTable(
        rows,
        colWidths=_widths(table),
        style=style,
        repeatRows=int(any(table.head)),
        spaceBefore=4,
        spaceAfter=4,
    )


def _widths(table: Table) -> list[float]:
    """By the longest text of each column, within bounds."""
    columns = list(zip(table.head, *table.rows, strict=True))
    wanted = [min(46.0, max(6.0, *(0.8 * len(text) + 3.0 for text in column))) for column in columns]
    # No word is cut, but digests are.
    words = [
        max(len(word) for text in column for word in text.replace(" ± ", "_±_").split() or [""])
        for column in columns
    ]
    wanted = [max(each, min(1.15 * word + 3.0, 30.0)) for each, word in zip(wanted, words, strict=True)]
    return [_WIDTH * each / sum(wanted) for each in wanted]


def _foot(canvas: Canvas, title: str, page: int) -> None:
    canvas.setFont(_FONT, 7)
    canvas.setFillColor(_GREY)
    canvas.drawString(_MARGIN, 10 * mm, title[:100])
    canvas.drawRightString(A4[0] - _MARGIN, 10 * mm, f"{page}")


class _Drawn(Flowable):  # type: ignore[misc]
    """A drawing in the flow of a page."""

    def __init__(self, drawing: Drawing) -> None:
        super().__init__()
        self._drawing = drawing
        self._scale = min(1.0, _WIDTH / (drawing.width * mm)) * mm
        self.width, self.height = drawing.width * self._scale, drawing.height * self._scale

    def wrap(self, *_: float) -> tuple[float, float]:
        """Width and height."""
        return self.width, self.height

    def draw(self) -> None:
        """On the page's canvas, whose y goes up."""
        canvas: Canvas = self.canv
        for shape in self._drawing.shapes:
            match shape:
                case Area(points, fill):
                    canvas.setFillColor(colors.HexColor(fill))
                    canvas.drawPath(self._path(points, closed=True), stroke=0, fill=1)
                case Line(points, colour, width, dashed):
                    canvas.setStrokeColor(colors.HexColor(colour))
                    canvas.setLineWidth(width * self._scale)
                    canvas.setDash(*(((1.2 * self._scale, 0.8 * self._scale), 0) if dashed else ()))
                    canvas.drawPath(self._path(points, closed=False), stroke=1, fill=0)
                case Text():
                    self._write(canvas, shape)

    def _path(self, points: Sequence[Point], *, closed: bool) -> object:
        path = self.canv.beginPath()
        for index, (x, y) in enumerate(points):
            (path.lineTo if index else path.moveTo)(x * self._scale, self.height - y * self._scale)
        if closed:
            path.close()
        return path

    def _write(self, canvas: Canvas, text: Text) -> None:
        font, size = _BOLD if text.bold else _FONT, text.size * self._scale
        x, y = text.x * self._scale, self.height - text.y * self._scale
        wide = pdfmetrics.stringWidth(text.text, font, size)
        x -= {"start": 0.0, "middle": 0.5, "end": 1.0}[text.anchor] * wide
        canvas.setFont(font, size)
        if text.halo:
            canvas.setStrokeColor(colors.white)
            canvas.setLineWidth(0.6 * self._scale)
            canvas.setDash()
            canvas.drawString(x, y, text.text, mode=1)
        canvas.setFillColor(colors.HexColor(text.colour))
        canvas.drawString(x, y, text.text, mode=0)
