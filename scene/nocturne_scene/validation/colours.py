"""Light of standard illuminants and black bodies: luminance and chromaticity."""

from collections.abc import Iterator

import numpy as np

from nocturne_scene.spectra import published
from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.documents import BLACK, Document, quad

ILLUMINANTS = {
    "A": (0.44758, 0.40745),
    "C": (0.31006, 0.31616),
    "D50": (0.34567, 0.35851),
    "D55": (0.33243, 0.34744),
    "D65": (0.31272, 0.32903),
    "D75": (0.29903, 0.31488),
    "E": (0.33333, 0.33333),
    "FL1": (0.3131, 0.3371),
    "FL2": (0.3721, 0.3751),
    "FL3": (0.4091, 0.3941),
    "FL4": (0.4402, 0.4031),
    "FL5": (0.3138, 0.3452),
    "FL6": (0.3779, 0.3882),
    "FL7": (0.3129, 0.3292),
    "FL8": (0.3458, 0.3586),
    "FL9": (0.3741, 0.3727),
    "FL10": (0.3458, 0.3588),
    "FL11": (0.3805, 0.3769),
    "FL12": (0.4370, 0.4042),
}
"""x, y of the CIE 1931 observer as the report prints them."""

BLACK_BODIES = (2042.15, 2856.0, 4000.0, 5772.0, 6500.0)
_CIE = "CIE 015:2018, tables of illuminants' x, y (FL: CIE 15:2004, table T.8)"
_PLANCK = "M. Planck 1900 with the constants of the SI of 2019, CIE 018:2019 observer, by sums of 1 nm"


def scenes() -> Iterator[Scene]:
    """A lamp that fills the image."""
    for name, (x, y) in ILLUMINANTS.items():
        document = _lamp({"illuminant": name, "luminance": 100.0})
        values = Value(f"{name}, cd/m2", 100.0, _CIE, "Y"), *_chromaticity(name, x, y, _CIE)
        # x and y of fluorescent lamps are printed to 5e-5, which must be little compared with the noise.
        yield Scene(document, values, 2**13 if name.startswith("FL") else 2**15)
    for kelvin in BLACK_BODIES:
        wavelengths = published.visible_wavelengths()
        weighed = published.planck(kelvin, wavelengths)[:, None] * published.observer("CIE 1931 2 degree")
        xyz = published.MAX_LUMINOUS_EFFICACY * np.asarray(np.trapezoid(weighed, wavelengths, axis=0))
        x, y = (float(each) for each in xyz[:2] / xyz.sum())
        name = f"black body of {kelvin:g} K"
        value = Value(f"{name}, cd/m2", float(xyz[1]), _PLANCK, "Y")
        yield Scene(_lamp({"blackbody": kelvin}), (value, *_chromaticity(name, x, y, _PLANCK)))


def _chromaticity(name: str, x: float, y: float, source: str) -> tuple[Value, Value]:
    below = -2.0 * x + 12.0 * y + 3.0
    return (
        Value(f"{name}, u'", 4.0 * x / below, source, "u'"),
        Value(f"{name}, v'", 9.0 * y / below, source, "v'"),
    )


def _lamp(radiance: Document) -> Document:
    camera = {"type": "orthographic", "position": [0, 0, 1], "look_at": [0, 0, 0], "height": 0.1}
    shape = quad([-1, -1, 0], [2, 0, 0], [0, 2, 0])
    surface = {"shape": shape, "kernel": BLACK, "luminaire": {"radiance": radiance}}
    return {"nocturne": 1, "sensor": camera, "surfaces": [surface]}
