"""Droplets by Mie's theory: against published cross-sections, limits on paper, and the cache."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs
import pytest
from nocturne_scene.compile import spectra
from nocturne_scene.media import mie
from nocturne_scene.spectra.published import Floats
from nocturne_scene.spectra.wavelength_range import VISIBLE

from tests.scene.conftest import Compile, Document
from tests.scene.test_media import with_media
from tests.spheres import elements

HAZE_M = mie.Distribution(0.05e-6, 1, 0.5)
HAZE_L = mie.Distribution(0.07e-6, 2, 0.5)
CLOUD_C1 = mie.Distribution(4e-6, 6, 1)
WATER = (1.34, 1.335, 1.33)


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A separate cache, empty at first; and three wavelengths instead of 21, to be quick."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(platformdirs, "user_cache_path", lambda *_: folder)
        patch.setattr(mie, "wavelengths", lambda _=None: np.array([450.0, 575.0, 700.0]))
        mie._kept.cache_clear()
        yield folder
    mie._kept.cache_clear()


def mean_cosine(scattering: mie.Scattering) -> Floats:
    """Of lines between the cosines, exact: Simpson's rule on cosine times phase."""
    low, high = scattering.cosines[:-1], scattering.cosines[1:]
    first, last = scattering.phase[:, :-1], scattering.phase[:, 1:]
    middle = 0.25 * (low + high) * (first + last)
    return np.asarray(2 * np.pi * np.sum((low * first + 4 * middle + high * last) * (high - low) / 6, axis=1))


@pytest.mark.parametrize("distribution", [HAZE_M, HAZE_L, CLOUD_C1])
def test_distributions_are_normalised(distribution: mie.Distribution) -> None:
    """Deirmendjian's a for 100 droplets in a cm3, r in micrometres: a r^alpha exp(-b r^gamma)."""
    a, b = {HAZE_M: (5.3333e4, 8.9443), HAZE_L: (4.9757e6, 15.1186), CLOUD_C1: (2.3730, 1.5)}[distribution]
    radii = np.array([0.02, 0.1, 1.0, 5.0])
    published = a * radii**distribution.alpha * np.exp(-b * radii**distribution.gamma)
    assert 1e2 * 1e-6 * distribution.density(radii * 1e-6) == pytest.approx(published, rel=1e-3)


def efficiency_and_mean_cosine(index: float, size: float) -> tuple[float, float]:
    """Of one sphere: C. F. Bohren and D. R. Huffman 1983, equations 4.61 and the one after 4.62."""
    a, b = (rows[0] for rows in mie.coefficients(index, np.array([size])))
    n = np.arange(1, len(a) + 1)
    efficiency = 2 / size**2 * np.sum((2 * n + 1) * (np.abs(a) ** 2 + np.abs(b) ** 2))
    neighbours = (n * (n + 2) / (n + 1))[:-1] * (a[:-1] * a[1:].conj() + b[:-1] * b[1:].conj())
    pairs = (2 * n + 1) / (n * (n + 1)) * a * b.conj()
    return float(efficiency), float(4 / size**2 * (neighbours.sum() + pairs.sum()).real / efficiency)


# W. J. Wiscombe, Mie Scattering Calculations, NCAR Technical Note TN-140+STR, 1979: its test output.
_WISCOMBE = [
    (0.75, 10.0, 2.232265, 0.896473),
    (0.75, 1000.0, 1.997908, 0.844944),
    (1.5, 10.0, 2.881999, 0.742913),
    (1.5, 100.0, 2.094388, 0.818246),
    (1.5, 1000.0, 2.013945, 0.827882),
]


@pytest.mark.parametrize(("index", "size", "efficiency", "cosine"), _WISCOMBE)
def test_spheres_have_their_published_efficiency(
    index: float, size: float, efficiency: float, cosine: float
) -> None:
    """Up to the largest droplets that are accepted."""
    assert size <= mie.LARGEST_SIZE
    assert efficiency_and_mean_cosine(index, size) == pytest.approx((efficiency, cosine), abs=1e-6)


# Bohren and Huffman 1983, appendix A: index 1.55, radius 0.525 um, wavelength 0.6328 um; each 9 degrees.
_BOHREN_HUFFMAN = [
    *(1.0, 0.785390, 0.356897, 0.0766119, 0.0355355, 0.0701845, 0.0574313, 0.0219660, 0.0125959, 0.0173750),
    *(0.0124601, 0.00679093, 0.00954239, 0.00863419, 0.00227421, 0.00543998, 0.0160243, 0.0188852),
    *(0.0195254, 0.0301676, 0.0383189),
]


def test_a_sphere_scatters_into_directions_as_published() -> None:
    size = 2 * np.pi * 0.525 / 0.6328
    assert efficiency_and_mean_cosine(1.55, size)[0] == pytest.approx(3.10543, abs=5e-6)
    found = intensity(1.55, np.array([size]), np.cos(np.radians(9.0 * np.arange(21))))[0]
    assert found / found[0] == pytest.approx(np.array(_BOHREN_HUFFMAN), rel=2e-5)


# The same: polarisation -S12 / S11, S33 / S11 and S34 / S11.
_BOHREN_HUFFMAN_MATRIX = [
    (0.0, 1.0, 0.0),
    (-0.00459811, 0.999400, 0.0343261),
    (-0.0458541, 0.986022, 0.160184),
    (-0.364744, 0.843603, 0.394076),
    (-0.534997, 0.686967, -0.491787),
    (0.00959953, 0.959825, -0.280434),
    (0.0477927, 0.985371, 0.163584),
    (-0.440604, 0.648043, 0.621216),
    (-0.831996, 0.203255, -0.516208),
    (0.0341670, 0.795354, -0.605182),
    (0.230462, 0.937497, 0.260742),
    (-0.713472, -0.00717397, 0.700647),
    (-0.756255, -0.0394748, -0.653085),
    (-0.281215, 0.536251, -0.795835),
    (-0.239612, 0.967602, 0.0795798),
    (-0.850804, 0.187531, -0.490882),
    (-0.706334, 0.495254, -0.505781),
    (-0.891081, 0.453277, -0.0226817),
    (-0.783319, -0.391613, 0.482752),
    (-0.196194, -0.962069, 0.189556),
    (0.0, -1.0, 0.0),
]


def test_a_sphere_polarises_as_published() -> None:
    size = 2 * np.pi * 0.525 / 0.6328
    a, b = mie.coefficients(1.55, np.array([size]))
    n = np.arange(1, a.shape[1] + 1)
    scale = (2 * n + 1) / (n * (n + 1))
    series = mie._cosine_series(scale * a, scale * b, np.array([1.0]), True)
    angles = np.radians(9.0 * np.arange(21))
    s11, s12, s33, s34 = series @ np.cos(np.arange(series.shape[1])[:, None] * angles)
    found = np.stack([-s12, s33, s34], axis=-1) / s11[:, None]
    assert found == pytest.approx(np.array(_BOHREN_HUFFMAN_MATRIX), abs=2e-6)


def test_a_matrix_between_the_table_s_angles() -> None:
    """Of one wavelength by S1 and S2 themselves, sizes by another rule: both are good to 1 %."""
    found = mie.scattering(HAZE_L, WATER, polarised=True)
    assert found.matrix is not None
    which = 1
    wave = 2 * np.pi / (mie.wavelengths()[which] * 1e-9)
    radii = np.linspace(0.002e-6, 4e-6, 3000)
    weights = HAZE_L.density(radii) * (radii[1] - radii[0])
    angles = np.radians([0.0, 3.3, 17.1, 41.7, 63.3, 90.5, 120.2, 138.1, 165.4])
    total = np.stack([weights @ each for each in elements(WATER[which], wave * radii, np.cos(angles))])
    phase = np.interp(np.cos(angles), found.cosines, found.phase[which])
    table = [
        np.interp(np.cos(angles), found.cosines, each[which] * found.phase[which]) for each in found.matrix
    ]
    assert np.stack(table) / phase == pytest.approx(total[1:] / total[0], abs=0.02)
    assert np.abs(total[3] / total[0]).max() > 0.1


def test_a_matrix_is_no_more_than_was_asked_for(cache: Path) -> None:
    distribution = mie.Distribution(0.1e-6, 5, 2)
    plain = mie.scattering(distribution, WATER)
    assert plain.matrix is None
    assert mie.scattering(distribution, WATER, polarised=True).matrix is not None
    mie._kept.cache_clear()
    assert mie.scattering(distribution, WATER, polarised=True).matrix is not None
    assert np.array_equal(mie.scattering(distribution, WATER).phase, plain.phase)
    del cache


def intensity(index: float, sizes: Floats, cosines: Floats) -> Floats:
    """S11 of spheres, a row for each size."""
    return elements(index, sizes, cosines)[0]


@pytest.mark.parametrize("size", [50.0, 333.0, mie.LARGEST_SIZE])
def test_soft_spheres_take_light_by_the_phase_they_delay(size: float) -> None:
    """H. C. van de Hulst 1957, section 11.22: anomalous diffraction, exact as the index goes to 1."""
    index = 1.0003
    delay = 2 * size * (index - 1)
    expected = 2 - 4 / delay * np.sin(delay) + 4 / delay**2 * (1 - np.cos(delay))
    assert efficiency_and_mean_cosine(index, size)[0] == pytest.approx(expected, rel=5e-3)


def test_haze_has_its_published_extinction() -> None:
    """D. Deirmendjian 1969: haze M, 100 in a cm3, 0.1056 per km at 450 nm and 0.1055 at 700 nm."""
    found = mie.scattering(HAZE_M, WATER).cross_section[[0, 2]]
    assert 1e8 * 1e3 * found == pytest.approx([0.1056, 0.1055], rel=3e-3)


def test_large_droplets_take_twice_the_light_that_meets_them() -> None:
    """Q = 2 + 1.9924 x^(-2/3) (H. M. Nussenzveig and W. J. Wiscombe, Physical Review Letters 45, 1980)."""
    distribution = mie.Distribution(10e-6, 60, 1)
    large = mie.scattering(distribution, (1.33,) * 3)
    radii = np.linspace(1e-6, 40e-6, 20_000)
    area = np.pi * np.trapezoid(distribution.density(radii) * radii**2, radii)
    size = 2 * np.pi * 10e-6 / (mie.wavelengths() * 1e-9)
    assert large.cross_section / area == pytest.approx(2 + 1.9924 * size ** (-2 / 3), rel=5e-3)


def test_small_droplets_scatter_as_molecules_do() -> None:
    """Lord Rayleigh's cross-section, and 3 / (16 pi) (1 + cos^2)."""
    small = mie.scattering(mie.Distribution(2e-9, 20, 2), (1.33,) * 3)
    radii = np.linspace(1e-11, 1e-8, 20_000)
    sixth = np.trapezoid(mie.Distribution(2e-9, 20, 2).density(radii) * radii**6, radii)
    polarised = (1.33**2 - 1) / (1.33**2 + 2)
    rayleigh = 8 / 3 * np.pi * (2 * np.pi / (mie.wavelengths() * 1e-9)) ** 4 * polarised**2 * sixth
    assert small.cross_section == pytest.approx(rayleigh, rel=5e-3)
    phase = 3 / (16 * np.pi) * (1 + small.cosines**2)
    assert small.phase[0] == pytest.approx(phase, rel=0.01)


def test_the_forward_peak_is_resolved() -> None:
    """The phase function at other angles than the table's, and with other sizes.

    Lines between cosines are good to 1 %, and the sum over sizes to as much; the glory, near 180 degrees,
    lives on resonances of single sizes: 5 %.
    """
    found = mie.scattering(CLOUD_C1, WATER)
    assert (found.cosines[0], found.cosines[-1]) == (-1, 1)
    assert np.all(np.diff(found.cosines) > 0)
    angles = np.radians([0.0, 0.13, 0.7, 2.1, 11.0, 42.0, 90.5, 138.0, 143.3, 179.2, 180.0])
    radii = np.linspace(0.5e-6, 20e-6, 1000)
    which = 1
    wave = 2 * np.pi / (mie.wavelengths()[which] * 1e-9)
    weights = CLOUD_C1.density(radii) * (radii[1] - radii[0])
    total = weights @ intensity(WATER[which], wave * radii, np.cos(angles)) / wave**2
    table = np.interp(np.cos(angles), found.cosines, found.phase[which])
    truth = total / found.cross_section[which]
    assert table[:-2] == pytest.approx(truth[:-2], rel=0.02)
    assert table[-2:] == pytest.approx(truth[-2:], rel=0.05)


def test_a_row_is_a_density() -> None:
    found = mie.scattering(HAZE_L, WATER)
    total = 2 * np.pi * np.trapezoid(found.phase, found.cosines, axis=1)
    assert total == pytest.approx(np.ones(3), rel=1e-12)
    assert np.all((mean_cosine(found) > 0.78) & (mean_cosine(found) < 0.81))


def test_what_was_computed_is_kept(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    distribution = mie.Distribution(0.1e-6, 3, 2)
    made = mie.scattering(distribution, WATER)
    assert len(list(cache.glob("mie-*.npz"))) >= 1
    mie._kept.cache_clear()
    monkeypatch.setattr(mie, "_compute", lambda *_: pytest.fail("is there already"))
    again = mie.scattering(distribution, WATER)
    assert np.array_equal(made.phase, again.phase)
    assert np.array_equal(made.cross_section, again.cross_section)


def test_a_spoilt_file_is_made_again(cache: Path) -> None:
    distribution = mie.Distribution(0.1e-6, 4, 2)
    made = mie.scattering(distribution, WATER)
    mie._place(distribution, WATER, VISIBLE).write_bytes(b"spoilt")
    mie._kept.cache_clear()
    assert np.array_equal(mie.scattering(distribution, WATER).phase, made.phase)
    del cache


def test_a_preset_of_droplets(document: Document, compiled: Compile) -> None:
    """Haze of 100 droplets in a cm3, ten times as dense; as a phase function alone too."""
    droplets: dict[str, Any] = {"mode_radius": 0.07e-6, "alpha": 2, "gamma": 0.5}
    media = {
        "haze": {"preset": "continental haze", "density": 10},
        "same": {"droplets": droplets},
        "other": {"scattering": 2, "phase": {"type": "mie", "droplets": droplets}},
    }
    document = with_media(document, **media)
    document["unbounded_media"] = ["same", "other"]
    scene = compiled(document)
    haze, same, other = scene.media
    assert (haze.constant, same.constant) == (10, 1)
    assert haze.scattering == same.scattering
    assert haze.phase == same.phase == other.phase
    table = haze.phase.tabulated
    assert len(table.values) == len(table.wavelengths) * len(table.cosines)
    found = spectra.evaluate(scene.spectra[haze.scattering], mie.wavelengths())
    # Haze scatters blue light more than red; 0.048 per km at 450 nm for one part.
    assert found[0] > found[1] > found[2]
    assert found == pytest.approx([4.80e-5, 4.46e-5, 3.95e-5], rel=0.01)
