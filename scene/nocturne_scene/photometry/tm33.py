"""Luminaires as XML: ANSI/IES TM-33-18 and TM-33-23, UNI 11733 and ATLA S001, read; TM-33-23 written.

They name the same elements. Read are intensities in cd over the angles of types A, B and C, the spectrum of
an emitter, sizes and what describes the luminaire. Emitters shine together: intensities add up, and so do
spectra, each as bright as its emitter. A file with intensities in W/sr or in photons, and none in cd, needs a
spectrum.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from xml.sax.saxutils import escape

import numpy as np

from nocturne_scene.photometry.intensities import (
    LARGEST,
    MAX_ANGLES,
    MAX_VALUES,
    BadPhotometryError,
    Photometry,
    Spectrum,
    all_around,
    flux,
    need_type_c,
    number_text,
)
from nocturne_scene.photometry.types_a_and_b import about_an_axis
from nocturne_scene.photometry.xml_tree import Element, parse
from nocturne_scene.spectra import published
from nocturne_scene.spectra.published import Floats

ROOTS = ("IESTM33", "ATLA_S001", "UNI11733", "UNI_11733", "LuminaireOpticalData")
"""How the names of root elements begin."""

MAX_EMITTERS = 1000
_MAX_KNOTS = 100_000
_TYPES = {"IES_A": "A", "IES_B": "B", "IES_C": "C", "CIE_C": "C", "A": "A", "B": "B", "C": "C"}
_TYPES |= {f"Type{kind}": kind for kind in "ABC"}
_AVOGADRO = 6.02214076e23
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}")
_NOT_IN_XML = re.compile("[^\\t\\n\\x20-\\ud7ff\\ue000-\\ufffd\\U00010000-\\U0010ffff]")
_KEYWORDS = {
    "MANUFAC": ("Header", "Manufacturer"),
    "LUMCAT": ("Header", "CatalogNumber"),
    "LUMINAIRE": ("Header", "Description"),
    "TESTLAB": ("Header", "Laboratory"),
    "TEST": ("Header", "ReportNumber"),
    "ISSUEDATE": ("Header", "ReportDate"),
}


def read(data: bytes) -> Photometry:
    """Read a file; raises BadPhotometryError."""
    root = parse(data)
    if not root.tag.startswith(ROOTS):
        raise BadPhotometryError(
            root.line, f"<{root.tag[:40]}> is no luminaire; expected <IESTM33-22>, <IESTM33> or <ATLA_S001_A>"
        )
    emitters = list(root.all("Emitter"))
    if not 1 <= len(emitters) <= MAX_EMITTERS:
        raise BadPhotometryError(
            root.line, f"{len(emitters)} elements <Emitter>; expected 1 to {MAX_EMITTERS}"
        )
    kind = _kind(root)
    found = _together([_emitter(each, kind) for each in emitters], root.line)
    width, length, height = (
        _number(root, ("Luminaire", "Dimensions", name), "a size, m", 0.0)
        for name in ("Width", "Length", "Height")
    )
    keywords = {key: text for key, path in _KEYWORDS.items() if (text := root.text_at(*path))}
    return replace(found, opening=(width, length, height), keywords=keywords)


def _kind(root: Element) -> str:
    """Type of the photometry."""
    for path in (("Equipment", "Gonioradiometer", "Type"), ("Equipment", "Goniometer", "Type")):
        found = root.first(*path)
        if found is None:
            continue
        if found.text not in _TYPES:
            raise BadPhotometryError(
                found.line, f'<Type> is "{found.text[:40]}"; expected IES_A, IES_B, IES_C or CIE_C'
            )
        return _TYPES[found.text]
    return "C"


def _emitter(emitter: Element, kind: str) -> Photometry:
    spectrum = _spectrum(emitter)
    vertical, horizontal, candela, line = _intensities(emitter, spectrum)
    watts = _number(emitter, ("InputWattage",), "the input power, W", 0.0)
    if kind == "C":
        if not 0 <= vertical[0] <= vertical[-1] <= 180 or not 0 <= horizontal[0] <= horizontal[-1] <= 360:
            raise BadPhotometryError(
                line, "expected angles v within 0 and 180 and h within 0 and 360 degrees"
            )
        horizontal, candela = all_around(line, horizontal, candela)
        return Photometry(vertical, horizontal, candela, input_watts=watts, spectrum=spectrum)
    within = -90 <= vertical[0] <= vertical[-1] <= 90 and -90 <= horizontal[0] <= 0 < horizontal[-1] <= 90
    if not within or len(vertical) < 2:
        raise BadPhotometryError(
            line, f"expected of type {kind} angles v within -90 and 90, and h from -90 or 0 to 90 degrees"
        )
    turned = about_an_axis("B" if kind == "B" else "A", vertical, horizontal, candela)
    found = Photometry(turned.vertical, turned.horizontal, turned.candela, input_watts=watts)
    return replace(found, axis=turned.axis, zero=turned.zero, spectrum=spectrum)


def _together(emitters: Sequence[Photometry], line: int) -> Photometry:
    """All of them as one."""
    first, *others = emitters
    for each in others:
        alike = np.array_equal(first.vertical, each.vertical) and np.array_equal(
            first.horizontal, each.horizontal
        )
        if not alike:
            raise BadPhotometryError(line, "emitters have different angles; expected the same of all")
    spectra = [each.spectrum for each in emitters]
    return replace(
        first,
        candela=np.sum([each.candela for each in emitters], axis=0),
        input_watts=sum(each.input_watts for each in emitters),
        spectrum=_sum([flux(each) for each in emitters], spectra),
    )


def _sum(lumens: Sequence[float], spectra: Sequence[Spectrum | None]) -> Spectrum | None:
    """Of spectra of so much light; None where one is not known."""
    known = [spectrum for spectrum in spectra if spectrum is not None]
    if len(known) == 1 and len(spectra) == 1:
        return known[0]
    luminous = [_luminous(spectrum) for spectrum in known]
    if len(known) < len(spectra) or not all(luminous):
        return None
    nm = np.unique(np.concatenate([spectrum[0] for spectrum in known]))
    parts = (
        share / amount * np.interp(nm, *spectrum, left=0.0, right=0.0)
        for share, amount, spectrum in zip(lumens, luminous, known, strict=True)
    )
    return nm, np.sum(list(parts), axis=0)


def _luminous(spectrum: Spectrum) -> float:
    """Luminous flux of a spectrum in W/nm, lm."""
    nm = published.visible_wavelengths()
    curve = published.MAX_LUMINOUS_EFFICACY * published.observer("CIE 1931 2 degree")[:, 1]
    return float(np.interp(nm, *spectrum, left=0.0, right=0.0) @ curve)


def _intensities(emitter: Element, spectrum: Spectrum | None) -> tuple[Floats, Floats, Floats, int]:
    """Angles v and h, values over h and v in cd, and the line of their element."""
    luminous = emitter.first("LuminousData", "LuminousIntensity")
    if luminous is not None:
        return *_grid(luminous), luminous.line
    for data, name, photons in (
        ("RadiantData", "RadiantIntensity", False),
        ("PhotonData", "PhotonIntensity", True),
    ):
        found, around = emitter.first(data, name), emitter.first(data)
        if found is None or around is None:
            continue
        if spectrum is None:
            raise BadPhotometryError(
                found.line,
                f"<{name}> without a spectrum; expected <SpectralData>, which tells how much is seen",
            )
        span = [_number(around, (f"{end}Wavelength",), "a wavelength, nm", 0.0) for end in ("Min", "Max")]
        vertical, horizontal, values = _grid(found)
        return vertical, horizontal, values * _candela_in(spectrum, span, photons, found.line), found.line
    raise BadPhotometryError(emitter.line, "no intensities; expected <LuminousData> with <LuminousIntensity>")


def _candela_in(spectrum: Spectrum, span: Sequence[float], photons: bool, line: int) -> float:
    """In a W/sr between two wavelengths, or in a micromole of photons a second and sr."""
    nm = np.unique(
        np.clip(np.concatenate([spectrum[0], np.linspace(span[0], span[1], 1001)]), min(span), max(span))
    )
    watts = np.interp(nm, *spectrum, left=0.0, right=0.0)
    # Energy of a micromole of photons of a wavelength in nm, J.
    energy = 1e-6 * _AVOGADRO * published.PLANCK * published.LIGHT_SPEED / (1e-9 * nm)
    amount = float(np.trapezoid(watts / energy if photons else watts, nm)) if len(nm) > 1 else 0.0
    if not amount > 0:
        raise BadPhotometryError(line, f"the spectrum has no light from {span[0]:g} to {span[1]:g} nm")
    return _luminous(spectrum) / amount


def _grid(table: Element) -> tuple[Floats, Floats, Floats]:
    """Angles v and h, and values of shape (h, v)."""
    values: dict[tuple[float, float], float] = {}
    for each in table.all("IntData"):
        at = tuple(_float(each.attributes.get(name, ""), f"angle {name}", each.line) for name in "hv")
        value = _float(each.text, "an intensity", each.line)
        if value < 0 or len(values) >= MAX_VALUES:
            raise BadPhotometryError(
                each.line, f"<IntData> is {value:g}; expected at most {MAX_VALUES} intensities, not negative"
            )
        if (at[0], at[1]) in values:
            raise BadPhotometryError(each.line, f"<IntData> of h {at[0]:g} and v {at[1]:g} once more")
        values[at[0], at[1]] = value
    horizontal, vertical = (np.unique([at[axis] for at in values]) for axis in (0, 1))
    if not values or max(len(horizontal), len(vertical)) > MAX_ANGLES:
        raise BadPhotometryError(table.line, f"no <IntData>, or angles of one kind beyond {MAX_ANGLES}")
    for name, angles in (("NumberHorz", horizontal), ("NumberVert", vertical)):
        told = _number(table, (name,), "a number of angles", float(len(angles)))
        if told != len(angles):
            raise BadPhotometryError(table.line, f"<{name}> is {told:g}, and {len(angles)} angles are there")
    if len(values) != len(horizontal) * len(vertical):
        raise BadPhotometryError(
            table.line,
            f"{len(values)} <IntData> for {len(horizontal)} angles h and {len(vertical)} angles v; expected "
            "one for each pair",
        )
    factor = _number(table, ("Multiplier",), "a multiplier", 1.0)
    if not factor >= 0:
        raise BadPhotometryError(table.line, f"<Multiplier> is {factor:g}; expected none that is negative")
    ordered = np.array([[values[h, v] for v in vertical.tolist()] for h in horizontal.tolist()])
    if not np.all(factor * ordered <= LARGEST):
        raise BadPhotometryError(table.line, "an intensity is too large")
    return vertical, horizontal, factor * ordered


def _spectrum(emitter: Element) -> Spectrum | None:
    """Of any size; None where there is none."""
    found = emitter.first("SpectralData", "EmitterSpectral")
    if found is None:
        return None
    knots: dict[float, float] = {}
    for each in found.all("PwrData"):
        at = _float(each.attributes.get("w", ""), "wavelength w, nm", each.line)
        value = _float(each.text, "a power", each.line)
        if not (at > 0 and value >= 0 and at not in knots and len(knots) < _MAX_KNOTS):
            raise BadPhotometryError(
                each.line,
                f"<PwrData> of {at:g} nm is {value:g}; expected each wavelength once, none negative",
            )
        knots[at] = value
    nm = np.array(sorted(knots))
    values = np.array([knots[each] for each in nm.tolist()])
    if len(knots) < 2 or not values.max() > 0:
        raise BadPhotometryError(found.line, "a spectrum without light; expected two <PwrData> or more")
    return nm, values / values.max()


def _number(element: Element, path: tuple[str, ...], what: str, missing: float) -> float:
    found = element.first(*path)
    return missing if found is None or not found.text else _float(found.text, what, found.line)


def _float(text: str, what: str, line: int) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= LARGEST:
        raise BadPhotometryError(line, f'expected {what}, found "{text[:40]}"')
    return value


def write(photometry: Photometry) -> bytes:
    """Write a file of TM-33-23. Read back, it is equal. Raises ValueError for other types than C."""
    need_type_c(photometry)
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', "<IESTM33-22>", "<Version>1.1</Version>", "<Header>"]
    lines += list(_header(photometry.keywords))
    width, length, height = (max(0.0, abs(each)) for each in photometry.opening)
    lines += ["</Header>", "<Luminaire>", "<Dimensions>"]
    lines += [
        f"<{name}>{number_text(value)}</{name}>"
        for name, value in zip(("Length", "Width", "Height"), (length, width, height), strict=True)
    ]
    lines += [
        "</Dimensions>",
        "<NumEmitter>1</NumEmitter>",
        "</Luminaire>",
        "<Equipment>",
        "<Gonioradiometer>",
    ]
    lines += [
        "<Type>IES_C</Type>",
        "</Gonioradiometer>",
        "</Equipment>",
        "<Emitter>",
        "<Quantity>1</Quantity>",
    ]
    lines += ["<Description>all of the luminaire</Description>"]
    lines += [f"<InputWattage>{number_text(photometry.input_watts)}</InputWattage>", "<DataGeneration>"]
    lines += ["<Simulation>true</Simulation>", "</DataGeneration>", "<LuminousData>", "<LuminousIntensity>"]
    vertical, horizontal = photometry.vertical, photometry.horizontal
    symmetry = "Symm_Full" if len(horizontal) == 1 else "Symm_None"
    lines += ["<AbsolutePhotometry>true</AbsolutePhotometry>", f"<Symm>{symmetry}</Symm>"]
    counts = {
        "NumberMeasured": photometry.candela.size,
        "NumberHorz": len(horizontal),
        "NumberVert": len(vertical),
    }
    lines += [f"<{name}>{count}</{name}>" for name, count in counts.items()]
    for h, row in zip(horizontal, photometry.candela, strict=True):
        lines += [
            f'<IntData h="{number_text(h)}" v="{number_text(v)}">{number_text(value)}</IntData>'
            for v, value in zip(vertical, row, strict=True)
        ]
    lines += ["</LuminousIntensity>", f"<LuminousFlux>{number_text(flux(photometry))}</LuminousFlux>"]
    lines += ["</LuminousData>", *_spectral(photometry.spectrum), "</Emitter>", "</IESTM33-22>", ""]
    return "\n".join(lines).encode()


def _header(keywords: Mapping[str, str]) -> Iterator[str]:
    """Those that TM-33 asks for, and others."""
    for key, (_, name) in _KEYWORDS.items():
        text = _xml_text(keywords.get(key, ""))
        if name == "ReportDate" and not _DATE.fullmatch(text):
            continue
        if text or name in ("Description", "Laboratory", "ReportNumber"):
            yield f"<{name}>{text or 'not said'}</{name}>"
    for key, value in keywords.items():
        if key not in _KEYWORDS:
            yield f"<Comment>{_xml_text(f'{key}: {value}')}</Comment>"


def _xml_text(text: str) -> str:
    return escape(_NOT_IN_XML.sub(" ", text)).strip()


def _spectral(spectrum: Spectrum | None) -> list[str]:
    if spectrum is None:
        return []
    nm, values = spectrum
    lines = ["<SpectralData>", "<EmitterSpectral>", f"<NumberWavelength>{len(nm)}</NumberWavelength>"]
    lines += [
        f'<PwrData w="{number_text(at)}">{number_text(value)}</PwrData>'
        for at, value in zip(nm, values, strict=True)
    ]
    return [*lines, "</EmitterSpectral>", "</SpectralData>"]
