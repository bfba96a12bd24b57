"""Picture files on surfaces, from file to render: the place of each part of a picture, and its colours.

Light of radiance 1 comes from everywhere, so a convex surface shows its reflectance: without noise, as the
directions are drawn by the cosine and a ratio of two images with the same random numbers has none left.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.validation.documents import quad, sphere

from tests.accuracy.spectral_meters import NO_ROULETTE
from tests.accuracy.tracing import Document, trace

pytestmark = pytest.mark.system

_BLOCK = 20
"""Pixels of a picture's file for each of its colours; the tested pixels are far from the edges."""

_SEEN = 5
"""Pixels of the film across a block."""

_CENTRES = slice(_SEEN // 2, None, _SEEN)

Colours = npt.NDArray[np.float32]

_SPHERE = sphere([1, 2, 3], 0.5)
_UPRIGHT = {"quad": quad([0, 2, 2.5], [2, 0, 0], [0, 0, 1]), "sphere": _SPHERE}
"""Seen along y, with z up and x to the right (the sphere: from the side where its u is 0.75)."""


@pytest.mark.parametrize("shape", _UPRIGHT)
def test_pictures_stand_upright(shape: str, tmp_path: Path) -> None:
    """The sphere shows the right half of the picture: from u = 0.5 at -x to u = 1 at x."""
    greys = np.array([[0.1, 0.2, 0.3, 0.4], [0.5, 0.6, 0.7, 0.8]], dtype=np.float32)
    seen = greys[:, 2:] if shape == "sphere" else greys
    _write(tmp_path / "picture.exr", greys[..., None])
    texture = {"texture": {"asset": "picture.exr"}, "spectrum": 1.0}
    document = _document(_UPRIGHT[shape], texture, radiance=1.0)
    white = _document(_UPRIGHT[shape], 1.0, radiance=1.0)
    images = [trace(each, tmp_path, (_SEEN * seen.shape[1], _SEEN * 2), 16) for each in (document, white)]
    ratio = images[0].y / images[1].y
    assert ratio[_CENTRES, _CENTRES] == pytest.approx(seen, abs=1e-5)


def test_colours_become_the_spectra_of_the_table(tmp_path: Path) -> None:
    """The tracer's look-up against the compiler's own, at seven wavelengths, of seeded colours.

    Lines of 0.01 nm are the only light, so a response sees one wavelength; by 0.01 nm spectra differ by less
    than 1e-3. All cells of the table: dark, bright, and with each channel the largest; and greys.
    """
    colours = np.random.default_rng(1).random((4, 6, 3), dtype=np.float32)
    colours[0] **= 4
    colours[1] = 1.0 - colours[1] ** 4
    colours[3] = np.linspace(0.0, 1.0, 6, dtype=np.float32)[:, None]
    _write(tmp_path / "picture.exr", colours)
    nm = np.array([400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0])
    lines = {"lines": [{"nm": each, "power": 1.0, "width": 0.01} for each in nm]}
    responses = {f"at-{each:g}": {"table": [[each - 1, 0], [each, 1], [each + 1, 0]]} for each in nm}
    shape = quad([0.25, 2, 2.5], [1.5, 0, 0], [0, 0, 1])
    textured, white = (
        trace(_document(shape, kind, lines, responses=responses), tmp_path, (6 * _SEEN, 4 * _SEEN), 256)
        for kind in ({"texture": {"asset": "picture.exr"}}, 1.0)
    )
    truth = rgb_spectra.spectra_of(rgb_spectra.rgb_to_coefficients(colours.astype(np.float64)), nm)
    for index, name in enumerate(responses):
        ratio = (textured.further[name] / white.further[name])[_CENTRES, _CENTRES]
        assert ratio == pytest.approx(truth[..., index], abs=1e-3), name


def _document(shape: Document, reflectance: object, radiance: object, **sensor: object) -> Document:
    return {
        "nocturne": 1,
        "sensor": {
            "type": "orthographic",
            "position": [1, 0, 3],
            "look_at": [1, 2, 3],
            "up": [0, 0, 1],
            "height": 1.0,
            **sensor,
        },
        "environment": {"radiance": radiance},
        "surfaces": [{"shape": shape, "kernel": {"type": "lambertian", "reflectance": reflectance}}],
        "tracing": {**NO_ROULETTE, "mixture": {"kernel": 1.0}},
    }


def _write(path: Path, colours: Colours) -> None:
    """A linear picture of blocks; row 0 is the top."""
    pixels = np.kron(colours, np.ones((_BLOCK, _BLOCK, 1), dtype=np.float32))
    buffer = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), pixels)
    assert buffer.write(str(path))
