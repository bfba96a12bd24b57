"""Ray files are read as IES TM-25-13 has them, read back as written, refused where wrong; their far field is
that of the lamp."""

import contextlib
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nocturne_scene.photometry import far_field, tm25
from nocturne_scene.photometry.meter_images import flux_of
from nocturne_scene.photometry.tm25 import BadRayFileError, RayFile

from tests.fuzzing import tried

_LIGHT = np.array([400.0, 550.0, 700.0]), np.array([0.25, 1.0, 0.5])


def lambertian(count: int, **more: Any) -> RayFile:
    """Rays of equal flux, together 1000 lm, along +z by the cosine, from a square of 1 cm."""
    chance = np.random.default_rng(5)
    sine, around = np.sqrt(chance.random(count)), 2 * np.pi * chance.random(count)
    directions = np.stack([sine * np.cos(around), sine * np.sin(around), np.sqrt(1 - sine**2)], axis=1)
    starts = np.append(chance.uniform(-0.005, 0.005, (count, 2)), np.zeros((count, 1)), axis=1)
    flux = np.full(count, 1000.0 / count, dtype=np.float32)
    known = {"watts": None, "lumens": flux} | more
    return RayFile(starts.astype(np.float32), directions.astype(np.float32), **known)


@pytest.fixture
def written(tmp_path: Path) -> Path:
    path = tmp_path / "lamp.TM25RAY"
    tm25.write(path, lambertian(100, spectra=[_LIGHT], texts=["Lämp", "Nobody"]))
    return path


def test_the_layout_is_that_of_the_standard(written: Path) -> None:
    """Offsets by sections 4.7.1 to 4.7.4; rays begin after a table of n pairs at 36288 + 4 + 8 n, filled up
    to 32 bytes: those of makers with 51 pairs at 36704."""
    data = written.read_bytes()
    assert data[:4] == b"TM25"
    assert struct.unpack_from("<i", data, 4) == (2013,)
    assert struct.unpack_from("<fQ", data, 12)[0] == pytest.approx(1000)
    assert struct.unpack_from("<Q", data, 20) == (100,)
    assert struct.unpack_from("<i", data, 60) == (3,)
    assert struct.unpack_from("<8i", data, 256) == (1, 1, 0, 0, 1, 0, 0, 0)
    assert data[288:304].decode("utf-32-le") == "Lämp"
    assert struct.unpack_from("<iff", data, 36288) == (3, 400.0, 0.25)
    assert len(data) == 36288 + 32 + 100 * 7 * 4
    # Places in mm.
    assert np.abs(np.frombuffer(data, "<f4", 7, 36320)[:2]).max() <= 5.0


@pytest.mark.parametrize("kind", ["none", "wavelengths", "one", "several"])
def test_what_is_written_reads_back(tmp_path: Path, kind: str) -> None:
    count = 50
    kinds: dict[str, dict[str, Any]] = {
        "none": {},
        "wavelengths": {"wavelengths": np.linspace(400, 700, count, dtype=np.float32)},
        "one": {"spectra": [_LIGHT]},
        "several": {"spectra": [_LIGHT, _LIGHT], "spectrum_of": np.arange(count, dtype=np.int32) % 2},
    }
    made = lambertian(count, watts=np.arange(count, dtype=np.float32), lumens=None, **kinds[kind])
    tm25.write(tmp_path / "a.tm25ray", made)
    found = tm25.read(tmp_path / "a.tm25ray")
    assert found.starts == pytest.approx(made.starts, abs=1e-9)
    assert found.directions == pytest.approx(made.directions, abs=1e-6)
    assert found.watts is not None
    assert np.array_equal(found.watts, np.arange(count))
    assert found.lumens is None
    for name in ("wavelengths", "spectrum_of"):
        one, other = getattr(found, name), getattr(made, name)
        assert (one is None and other is None) or np.array_equal(one, other)
    for spectrum, expected in zip(found.spectra, made.spectra, strict=True):
        assert np.array_equal(spectrum, expected)
    tm25.write(tmp_path / "b.tm25ray", found)
    again = (tmp_path / "b.tm25ray").read_bytes()
    assert again[:36288] == (tmp_path / "a.tm25ray").read_bytes()[:36288]


def test_further_columns_and_texts_are_read_past(written: Path) -> None:
    """A writer of electric fields has more numbers for each ray, whose names come before the rays."""
    data = bytearray(written.read_bytes())
    data[80:88] = struct.pack("<ii", 1, 64)
    rays = np.frombuffer(bytes(data[36320:]), "<f4").reshape(100, 7)
    wider = np.append(rays, np.full((100, 1), 7, dtype="<f4"), axis=1).astype("<f4")
    written.write_bytes(bytes(data[:36320]) + bytes(512) + bytes(64) + wider.tobytes())
    found = tm25.read(written)
    assert found.lumens is not None
    assert found.lumens.sum() == pytest.approx(1000, rel=1e-5)


@pytest.mark.parametrize(
    ("at", "bytes_there", "message"),
    [
        (0, b"XM25", "byte 0: expected TM25 and 2013, found b'XM25' and 2013"),
        (4, struct.pack("<i", 2020), "byte 0: expected TM25 and 2013, found b'TM25' and 2020"),
        (20, struct.pack("<Q", 0), "byte 20: 0 rays; expected 1 to 100000000"),
        (20, struct.pack("<Q", 99), "byte 36320: 99 rays of 7 numbers need 2772 bytes, and 2800 follow"),
        (60, struct.pack("<i", 9), "byte 60: the spectral data identifier is 9; expected 0 to 4"),
        (60, struct.pack("<i", 2), "byte 268: rays without wavelengths, which their identifier needs"),
        (60, struct.pack("<i", 4), "byte 284: indices of spectra and their identifier disagree"),
        (76, struct.pack("<i", 0), "byte 76: 0 spectral tables; expected 1 to 10000"),
        (80, struct.pack("<i", -1), "byte 80: -1 further columns; expected 0 to 64"),
        (84, struct.pack("<i", -4), "byte 84: a text of -4 bytes; expected one that fits into the file"),
        (256, struct.pack("<i", 0), "byte 256: a flag of known data is 0; expected 1"),
        (276, struct.pack("<i", 2), "byte 276: a flag of known data is 2; expected 0 or 1"),
        (272, struct.pack("<i", 0), "byte 264: rays without flux; expected a radiant or luminous one"),
        (
            36288,
            struct.pack("<i", 10**9),
            "byte 36288: a spectral table of 1000000000 pairs; expected 1 to 100000",
        ),
        (36292, struct.pack("<f", 600), "byte 36288: a spectral table; expected increasing wavelengths"),
        (36320, struct.pack("<f", np.nan), "byte 36320: ray 1: expected a place, x, y and z in mm"),
        (
            36320 + 28 + 12,
            struct.pack("<fff", 0, 0, 0),
            "byte 36348: ray 2: expected a direction of length 1",
        ),
        (36320 + 24, struct.pack("<f", -1), "byte 36320: ray 1: expected lumens, not negative"),
    ],
)
def test_refused(written: Path, at: int, bytes_there: bytes, message: str) -> None:
    data = bytearray(written.read_bytes())
    data[at : at + len(bytes_there)] = bytes_there
    written.write_bytes(data)
    with pytest.raises(BadRayFileError) as refused:
        tm25.read(written)
    assert str(refused.value).startswith(message)


def test_cut_or_spoilt_files_are_refused_in_words_or_read(written: Path) -> None:
    whole, size = written.read_bytes(), written.stat().st_size
    places = st.integers(0, 399) | st.integers(36288, size - 4)

    @given(
        patches=st.lists(st.tuples(places, st.binary(min_size=4, max_size=4)), min_size=1, max_size=3),
        length=st.integers(0, size) | st.just(size),
    )
    @tried(100)
    def run(patches: list[tuple[int, bytes]], length: int) -> None:
        made = bytearray(whole)
        for at, patch in patches:
            made[at : at + 4] = patch
        written.write_bytes(made[:length])
        with contextlib.suppress(BadRayFileError):
            assert np.all(np.isfinite(tm25.read(written).starts))

    run()


def test_the_far_field_of_a_lambertian() -> None:
    """1000 lm have 1000 / pi cd ahead; errors are those of counted rays."""
    candela, error = far_field.candela_of(lambertian(200_000), 8, 18)
    lumens, its_error = flux_of(candela, error)
    assert lumens == pytest.approx(1000, rel=1e-6)
    edges = np.linspace(0, np.pi, 19)
    # The mean of the cosine over a cell: that over its edges.
    expected = np.maximum(0, 1000 / np.pi * (np.cos(edges[1:]) + np.cos(edges[:-1])) / 2)[:, None]
    z = ((candela - expected) / np.where(error > 0, error, 1))[:9]
    assert abs(z.mean()) < 4 / np.sqrt(z.size)
    assert 0.8 < z.std() < 1.2
    assert not candela[9:].any()
    assert 0 < its_error < 10


def test_axes_of_the_far_field() -> None:
    """z is straight down, x is C0, and C increases counter-clockwise for someone who looks along z: C90 is at
    -y."""
    for direction, row, column in (
        ((0, 0, 1), 0, None),
        ((1, 0.1, 0), 1, 3),
        ((1, -0.1, 0), 1, 0),
        ((0.1, -1, 0), 1, 0),
    ):
        unit = np.array([direction], dtype=np.float64) / np.linalg.norm(direction)
        rays = RayFile(np.zeros((1, 3), np.float32), unit.astype(np.float32), None, np.ones(1, np.float32))
        candela, _ = far_field.candela_of(rays, 4, 3)
        found = np.argwhere(candela > 0)[0]
        assert found[0] == row
        assert column is None or found[1] == column


@pytest.mark.parametrize(
    "more",
    [
        {"wavelengths": np.full(1000, 555, dtype=np.float32)},
        {"spectra": [(np.array([554.5, 555.0, 555.5]), np.array([0.0, 1.0, 0.0]))]},
    ],
)
def test_watts_become_lumens_by_the_spectrum(more: dict[str, Any]) -> None:
    """A watt of 555 nm has 683 lm."""
    rays = lambertian(1000, watts=np.full(1000, 1e-3, dtype=np.float32), lumens=None, **more)
    assert far_field.lumens_of(rays).sum() == pytest.approx(683, rel=1e-3)


def test_watts_without_a_spectrum_are_refused() -> None:
    rays = lambertian(10, watts=np.ones(10, dtype=np.float32), lumens=None)
    with pytest.raises(ValueError, match="watts and no spectrum"):
        far_field.lumens_of(rays)
