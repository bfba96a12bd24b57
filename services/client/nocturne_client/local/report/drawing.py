"""Drawings of a few kinds of shapes, as SVG and as PNG. Lengths are millimetres, y goes down."""

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from xml.sax.saxutils import escape

_DOTS = 8.0
"""A millimetre of a PNG: 203 to the inch."""
_FINER = 2
"""A PNG is drawn so many times as large, and then made smaller."""
_POINTS = 2.834645669
"""In a millimetre."""

Point = tuple[float, float]


@dataclass(frozen=True)
class Area:
    """A filled polygon."""

    points: Sequence[Point]
    fill: str


@dataclass(frozen=True)
class Line:
    """A line through points."""

    points: Sequence[Point]
    colour: str = "#222222"
    width: float = 0.2
    dashed: bool = False


@dataclass(frozen=True)
class Text:
    """One line of text, whose baseline is at y."""

    x: float
    y: float
    text: str
    size: float = 2.8
    """Height of the letters' square, mm."""
    anchor: str = "start"
    """start, middle or end."""
    colour: str = "#222222"
    bold: bool = False
    halo: bool = False
    """White around the letters, for a ground of many colours."""


Shape = Area | Line | Text


@dataclass
class Drawing:
    """Shapes on white paper, the later ones over the earlier."""

    width: float
    height: float
    shapes: list[Shape] = field(default_factory=list)
    title: str = ""
    """A description, for those who don't see it."""

    def add(self, *shapes: Shape) -> None:
        """Over those that are there."""
        self.shapes.extend(shapes)

    def rectangle(self, x: float, y: float, width: float, height: float, fill: str) -> None:
        """Its upper left corner is at (x, y)."""
        self.add(Area(((x, y), (x + width, y), (x + width, y + height), (x, y + height)), fill))


def svg(drawing: Drawing, *, alone: bool = True) -> str:
    """SVG, UTF-8; `alone`: a file by itself, and not a part of a page."""
    size = f'width="{drawing.width:.2f}mm" height="{drawing.height:.2f}mm"' if alone else 'width="100%"'
    head = 'xmlns="http://www.w3.org/2000/svg" ' if alone else ""
    title = escape(drawing.title)
    return (
        f'<svg {head}viewBox="0 0 {drawing.width:.2f} {drawing.height:.2f}" {size} role="img" '
        f'font-family="sans-serif"><title>{title}</title><rect width="100%" height="100%" fill="#ffffff"/>'
        f"{''.join(map(_as_svg, drawing.shapes))}</svg>\n"
    )


def _as_svg(shape: Shape) -> str:
    match shape:
        case Area(points, fill):
            return f'<polygon points="{_places(points)}" fill="{fill}" shape-rendering="crispEdges"/>'
        case Line(points, colour, width, dashed):
            dash = ' stroke-dasharray="1.2 0.8"' if dashed else ""
            return (
                f'<polyline points="{_places(points)}" fill="none" stroke="{colour}" '
                f'stroke-width="{width:g}"{dash}/>'
            )
        case Text():
            weight = ' font-weight="bold"' if shape.bold else ""
            halo = ' stroke="#ffffff" stroke-width="0.6" paint-order="stroke"' if shape.halo else ""
            return (
                f'<text x="{shape.x:.2f}" y="{shape.y:.2f}" font-size="{shape.size:g}" fill="{shape.colour}" '
                f'text-anchor="{shape.anchor}"{weight}{halo}>{escape(shape.text)}</text>'
            )


def _places(points: Sequence[Point]) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in points)


def letters(*, bold: bool = False) -> Path:
    """A font with the letters of Western Europe: Bitstream Vera, which comes with ReportLab."""
    import reportlab

    return Path(reportlab.__file__).parent / "fonts" / ("VeraBd.ttf" if bold else "Vera.ttf")


def png(drawing: Drawing) -> bytes:
    """A picture of 203 dots to the inch."""
    from PIL import Image, ImageDraw, ImageFont

    scale = _DOTS * _FINER
    size = round(drawing.width * scale), round(drawing.height * scale)
    picture = Image.new("RGB", size, "#ffffff")
    pen = ImageDraw.Draw(picture)
    fonts: dict[tuple[float, bool], ImageFont.FreeTypeFont] = {}
    for shape in drawing.shapes:
        match shape:
            case Area(points, fill):
                pen.polygon([(x * scale, y * scale) for x, y in points], fill=fill)
            case Line(points, colour, width, dashed):
                pieces = _dashes(points) if dashed else [points]
                for piece in pieces:
                    places = [(x * scale, y * scale) for x, y in piece]
                    pen.line(places, fill=colour, width=max(1, round(width * scale)), joint="curve")
            case Text():
                key = shape.size, shape.bold
                if key not in fonts:
                    font = str(letters(bold=shape.bold))
                    fonts[key] = ImageFont.truetype(font, max(1.0, shape.size * scale))
                anchor = {"start": "ls", "middle": "ms", "end": "rs"}[shape.anchor]
                at = (shape.x * scale, shape.y * scale)
                halo = round(0.3 * scale) if shape.halo else 0
                pen.text(
                    at, shape.text, shape.colour, fonts[key], anchor, stroke_width=halo, stroke_fill="#ffffff"
                )
    smaller = picture.resize((size[0] // _FINER, size[1] // _FINER), Image.Resampling.BOX)
    bytes_made = io.BytesIO()
    dots = (_DOTS * 25.4, _DOTS * 25.4)
    smaller.save(bytes_made, "PNG", dpi=dots, optimize=True)
    return bytes_made.getvalue()


def _dashes(points: Sequence[Point]) -> list[Sequence[Point]]:
    """Pieces of 1.2 mm with gaps of 0.8 mm, of each straight part."""
    found: list[Sequence[Point]] = []
    for (x0, y0), (x1, y1) in pairwise(points):
        length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
        for start in range(int(length / 2.0) + 1):
            first, last = 2.0 * start / max(length, 1e-9), min(1.0, (2.0 * start + 1.2) / max(length, 1e-9))
            if first < last:
                found.append([(x0 + part * (x1 - x0), y0 + part * (y1 - y0)) for part in (first, last)])
    return found
