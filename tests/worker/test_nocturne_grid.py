"""nocturne-grid: arrays to OpenVDB to what the worker reads; and files that nobody should have to read."""

import json
import struct
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_client.local.programs import need_program

Values = npt.NDArray[np.float32]


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [str(need_program("nocturne-grid")), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def answer(*arguments: object) -> Any:
    done = run(*arguments)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def refusal(*arguments: object) -> str:
    """The message about refused input."""
    done = run(*arguments)
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stdout == ""
    return done.stderr


def ball(shape: tuple[int, int, int] = (40, 30, 20)) -> Values:
    x, y, z = np.meshgrid(*(np.arange(n) - n / 2 for n in shape), indexing="ij")
    values: Values = np.maximum(0, 1 - np.sqrt(x**2 + y**2 + z**2) / 9).astype(np.float32)
    return values


def write_input(folder: Path, arrays: dict[str, Values], **more: Any) -> Path:
    entries = []
    for name, values in arrays.items():
        values.astype("<f4").tofile(folder / f"{name}.f32")
        entries.append({"name": name, "file": f"{name}.f32"})
    shape = next(iter(arrays.values())).shape
    path = folder / "input.json"
    path.write_text(json.dumps({"dims": shape, "voxel_size": 0.1, "grids": entries, **more}))
    return path


@pytest.fixture
def smoke(tmp_path: Path) -> Path:
    """An OpenVDB file of two grids."""
    path = tmp_path / "smoke.vdb"
    arrays = {"density": ball(), "heat": 1000 * ball()}
    answer("create", write_input(tmp_path, arrays, origin=[1, 2, 3]), "-o", path)
    return path


def nano_values(path: Path, shape: tuple[int, int, int]) -> Values:
    """All voxels from index 0 on, by the layout that NanoVDB.h (version 32) describes; one root node."""
    data = path.read_bytes()
    tree = 672
    root = tree + struct.unpack_from("<Q", data, tree + 24)[0]
    assert struct.unpack_from("<I", data, root + 24)[0] == 1
    upper = root + struct.unpack_from("<q", data, root + 64 + 8)[0]
    background = struct.unpack_from("<f", data, root + 28)[0]
    values = np.full(shape, background, np.float32)
    lower = child(data, upper, 8256, 4096, 0)
    assert not isinstance(lower, float)
    for slot in range(4096):
        x, y, z = 8 * (slot >> 8), 8 * (slot >> 4 & 15), 8 * (slot & 15)
        if x < shape[0] and y < shape[1] and z < shape[2]:
            found = child(data, lower, 1088, 512, slot)
            block = values[x : x + 8, y : y + 8, z : z + 8]
            if isinstance(found, float):
                block[:] = found
            else:
                leaf = np.frombuffer(data, "<f4", 512, found + 96).reshape(8, 8, 8)
                block[:] = leaf[: block.shape[0], : block.shape[1], : block.shape[2]]
    return values


def child(data: bytes, node: int, table: int, mask_bytes: int, slot: int) -> int | float:
    """Where a node's child is, or the value that stands for it."""
    mask = node + 32 + mask_bytes + slot // 8
    at = node + table + 8 * slot
    if data[mask] >> slot % 8 & 1:
        return node + int(struct.unpack_from("<q", data, at)[0])
    return float(struct.unpack_from("<f", data, at)[0])


def test_what_goes_in_comes_out(smoke: Path, tmp_path: Path) -> None:
    told = answer("convert", smoke, "--grid", "density", "-o", tmp_path / "density.nvdb")
    values = ball()
    np.testing.assert_array_equal(nano_values(tmp_path / "density.nvdb", (40, 30, 20)), values)
    assert told["voxels"] == np.count_nonzero(values)
    assert told["most"] == 1
    assert told["bytes"] == (tmp_path / "density.nvdb").stat().st_size
    assert told["transform"] == pytest.approx([0.1, 0, 0, 1, 0, 0.1, 0, 2, 0, 0, 0.1, 3])


def test_inspect_tells_of_every_grid(smoke: Path) -> None:
    density, heat = answer("inspect", smoke)["grids"]
    assert (density["name"], density["type"], density["class"]) == ("density", "float", "fog volume")
    where = np.argwhere(ball() > 0)
    low, high = where.min(axis=0), where.max(axis=0)
    assert density["index_box"] == [low.tolist(), high.tolist()]
    space = [(low - 0.5) * 0.1 + [1, 2, 3], (high + 0.5) * 0.1 + [1, 2, 3]]
    np.testing.assert_allclose(density["world_box"], space, rtol=1e-12)
    assert heat["most"] == 1000
    assert heat["least"] == pytest.approx(1000 * ball()[ball() > 0].min())


def test_what_is_even_takes_no_memory(tmp_path: Path) -> None:
    """96 cubed of one value: tiles, in the file and in the worker's layout."""
    path = tmp_path / "even.vdb"
    answer("create", write_input(tmp_path, {"density": np.full((96, 96, 96), 2, np.float32)}), "-o", path)
    told = answer("convert", path, "--grid", "density", "-o", tmp_path / "even.nvdb")
    assert told["voxels"] == 96**3
    assert told["bytes"] < 96**3
    np.testing.assert_array_equal(nano_values(tmp_path / "even.nvdb", (96, 96, 96)), 2)


def test_values_are_those_that_went_in(smoke: Path, tmp_path: Path) -> None:
    """What `create` took, in a box of whole blocks of 8; and tiles, which have no blocks, with it."""
    answer("convert", smoke, "--grid", "density", "-o", tmp_path / "density.nvdb")
    told = answer("values", tmp_path / "density.nvdb", "-o", tmp_path / "values.f32")
    values = np.fromfile(tmp_path / "values.f32", "<f4").reshape(told["dims"])
    first = np.array(told["first_voxel"])
    assert np.all(first % 8 == 0)
    at = np.argwhere(ball() > 0)
    assert np.all(at.min(axis=0) >= first)
    found = np.zeros((64, 64, 64), np.float32)
    found[tuple(slice(low, low + n) for low, n in zip(first, told["dims"], strict=True))] = values
    np.testing.assert_array_equal(found[:40, :30, :20], ball())
    assert np.count_nonzero(found) == len(at)
    assert told["background"] == 0
    assert told["transform"] == pytest.approx([0.1, 0, 0, 1, 0, 0.1, 0, 2, 0, 0, 0.1, 3])


def test_values_of_tiles_and_a_background(tmp_path: Path) -> None:
    entry = {"name": "density", "file": "density.f32", "background": 0.5}
    even = np.full((32, 32, 32), 2, np.float32)
    even[3, 4, 5] = 1
    description = write_input(tmp_path, {"density": even}, grids=[entry])
    answer("create", description, "-o", tmp_path / "even.vdb")
    answer("convert", tmp_path / "even.vdb", "--grid", "density", "-o", tmp_path / "even.nvdb")
    told = answer("values", tmp_path / "even.nvdb", "-o", tmp_path / "values.f32")
    assert (told["dims"], told["first_voxel"], told["background"]) == ([32, 32, 32], [0, 0, 0], 0.5)
    np.testing.assert_array_equal(np.fromfile(tmp_path / "values.f32", "<f4"), even.ravel())


def test_values_are_counted_before_memory_is_taken(tmp_path: Path) -> None:
    """Two voxels far apart: 4000 x 8 x 8 in whole blocks, one more than are allowed."""
    far = np.zeros((1, 1, 4000), np.float32)
    far[0, 0, [0, -1]] = 1
    answer("create", write_input(tmp_path, {"density": far}), "-o", tmp_path / "far.vdb")
    answer("convert", tmp_path / "far.vdb", "--grid", "density", "-o", tmp_path / "far.nvdb")
    out = tmp_path / "out.f32"
    said = refusal("values", tmp_path / "far.nvdb", "-o", out, "--max-voxels", 64 * 4000 - 1)
    assert "more than 255999 voxels (--max-voxels)" in said
    assert list(tmp_path.glob("out*")) == []


def test_values_of_what_is_no_grid(tmp_path: Path) -> None:
    (tmp_path / "text.nvdb").write_text("not a grid at all\n" * 1000)
    assert "is no NanoVDB buffer" in refusal("values", tmp_path / "text.nvdb", "-o", tmp_path / "out.f32")


def test_tolerance_drops_what_is_thin(tmp_path: Path) -> None:
    entry = {"name": "density", "file": "density.f32", "tolerance": 0.25, "half": True}
    description = write_input(tmp_path, {"density": ball()}, grids=[entry])
    answer("create", description, "-o", tmp_path / "thin.vdb")
    answer("convert", tmp_path / "thin.vdb", "--grid", "density", "-o", tmp_path / "thin.nvdb")
    expected = np.where(ball() > 0.25, ball(), 0).astype(np.float16).astype(np.float32)
    np.testing.assert_array_equal(nano_values(tmp_path / "thin.nvdb", (40, 30, 20)), expected)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"dims": [2000, 2000, 2000]}, "voxels (--max-voxels)"),
        ({"dims": [2**40, 2**40, 2**40]}, "voxels (--max-voxels)"),
        ({"dims": [0, 3, 3]}, '"dims" are at least 1'),
        ({"dims": [40, 30]}, '"dims" is not of the right type'),
        ({"dims": [40, 30, 21]}, "bytes, not the 100800 of its dims"),
        ({"voxel_size": 0}, '"voxel_size" is not positive'),
        ({"colour": 1}, '"colour" is not known'),
        ({"grids": []}, '"grids" is empty'),
        ({"grids": [{"name": "a"}]}, '"file" is missing'),
        ({"grids": [{"name": "a", "file": "none.f32"}]}, "none.f32: can't be read"),
        ({"grids": [{"name": "a", "file": "density.f32", "background": -1}]}, "not negative"),
        ({"grids": [{"name": "a", "file": "density.f32", "half": 3}]}, '"half" is not of the right type'),
    ],
)
def test_create_says_what_is_wrong(tmp_path: Path, change: dict[str, Any], words: str) -> None:
    description = write_input(tmp_path, {"density": ball()}, **change)
    assert words in refusal("create", description, "-o", tmp_path / "out.vdb")
    assert not (tmp_path / "out.vdb").exists()


@pytest.mark.parametrize("bad", [-1.0, float("nan"), float("inf")])
def test_create_takes_densities_only(tmp_path: Path, bad: float) -> None:
    values = ball()
    values[1, 2, 3] = bad
    said = refusal("create", write_input(tmp_path, {"density": values}), "-o", tmp_path / "out.vdb")
    assert f"value {(1 * 30 + 2) * 20 + 3} is" in said


def patched(path: Path, old: bytes, new: bytes) -> Path:
    data = path.read_bytes()
    assert old in data
    changed = path.with_name("patched.vdb")
    changed.write_bytes(data.replace(old, new))
    return changed


def test_a_billion_voxels_in_the_header(smoke: Path, tmp_path: Path) -> None:
    data = bytearray(smoke.read_bytes())
    # Name, then "int64" and the value, each after its length.
    at = data.index(b"file_voxel_count") + len("file_voxel_count") + 4 + len("int64") + 4
    data[at : at + 8] = struct.pack("<q", 1_000_000_000)
    huge, out = tmp_path / "huge.vdb", tmp_path / "out.nvdb"
    huge.write_bytes(data)
    words = "says that it has 1000000000 voxels; at most 500000000 are read"
    assert words in refusal("convert", huge, "--grid", "density", "-o", out)
    assert words in refusal("inspect", huge)
    assert not out.exists()


def test_limits_hold(smoke: Path) -> None:
    assert "(--max-voxels)" in refusal("inspect", smoke, "--max-voxels", 100)
    assert "(--max-bytes)" in refusal("inspect", smoke, "--max-bytes", 1000)


@pytest.mark.parametrize("value", [-0.125, float("nan"), float("inf")])
def test_convert_takes_densities_only(tmp_path: Path, value: float) -> None:
    entry = {"name": "density", "file": "density.f32", "background": 0.125}
    path = tmp_path / "good.vdb"
    answer("create", write_input(tmp_path, {"density": ball()}, grids=[entry]), "-o", path)
    bad = patched(path, struct.pack("<f", 0.125), struct.pack("<f", value))
    said = refusal("convert", bad, "--grid", "density", "-o", tmp_path / "out.nvdb")
    assert "negative or not finite" in said
    assert list(tmp_path.glob("out*")) == []


def test_convert_wants_voxels(tmp_path: Path) -> None:
    path = tmp_path / "empty.vdb"
    answer("create", write_input(tmp_path, {"density": 0 * ball()}), "-o", path)
    assert "is empty" in refusal("convert", path, "--grid", "density", "-o", tmp_path / "out.nvdb")


def test_convert_knows_names(smoke: Path, tmp_path: Path) -> None:
    said = refusal("convert", smoke, "--grid", "fog", "-o", tmp_path / "out.nvdb")
    assert 'grid "fog" is not there; there are: "density", "heat"' in said


def test_what_is_no_file_of_grids(tmp_path: Path) -> None:
    assert "there is no such file" in refusal("inspect", tmp_path / "none.vdb")
    (tmp_path / "text.vdb").write_text("not a grid at all, but long enough to be one\n" * 100)
    assert "not an OpenVDB file" in refusal("inspect", tmp_path / "text.vdb")
    (tmp_path / "nothing.vdb").write_bytes(b"")
    assert "not an OpenVDB file" in refusal("inspect", tmp_path / "nothing.vdb")


@pytest.mark.parametrize("share", [0.02, 0.1, 0.5, 0.9, 0.999])
def test_truncated_files_are_refused(smoke: Path, tmp_path: Path, share: float) -> None:
    data = smoke.read_bytes()
    (tmp_path / "short.vdb").write_bytes(data[: int(share * len(data))])
    assert refusal("inspect", tmp_path / "short.vdb")


def test_damaged_files_end_in_words(smoke: Path, tmp_path: Path) -> None:
    """Any few bytes, most of them in the first kilobytes, where sizes and names are."""
    data = smoke.read_bytes()
    random = np.random.default_rng(20261121)
    refused = 0
    for _ in range(40):
        changed = bytearray(data)
        for _ in range(random.integers(1, 5)):
            span = 2000 if random.random() < 0.7 else len(data)
            changed[random.integers(0, span)] = random.integers(0, 256)
        (tmp_path / "bad.vdb").write_bytes(changed)
        to_read = [tmp_path / "bad.vdb", "--grid", "density", "-o", tmp_path / "out.nvdb"]
        done = run("convert", *to_read, "--max-bytes", 1_000_000_000)
        assert done.returncode in (0, 2)
        assert (done.returncode == 2) == done.stderr.startswith("nocturne-grid: ")
        refused += done.returncode == 2
    assert refused > 0


def test_help_and_mistakes() -> None:
    assert "inspect" in run("--help").stdout
    assert run().returncode == 2
    assert run("convert", "a.vdb").returncode == 2
