"""What the tracer does in examples, as the profile by which the compiler optimises: `make profile`.

A program that counts (`cmake --preset profile`) traces them with one thread, as its counters are not safe
between threads.
"""

import os
import tempfile
from pathlib import Path
from typing import Any

from nocturne_client.local.programs import CHECKOUT

from bench.peer.scenes import scenes
from bench.programs import run, trace_to
from bench.scenes import compile_document, example

PROFILE = CHECKOUT / "worker" / "tracing.profdata"
COUNTING = CHECKOUT / "build" / "profile" / "worker" / "nocturne-trace"

_BOTH = {"direction": "both", "forward_ratio": 4.0}

SCENES: dict[str, tuple[int, dict[str, Any]]] = {
    "cornell": (128, {"sharing": 16}),
    "fog": (128, {}),
    "subsurface": (128, {}),
    "sky": (128, {}),
    "glossy_spheres": (128, {"sharing": 16}),
    "both_directions": (128, {}),
    "mixtures": (128, {}),
    "reflector": (128, _BOTH),
    "headlight": (48, _BOTH),
    "spheres": (96, {}),
    "room": (64, {"sharing": 16}),
    "bumpy_spheres": (128, {}),
}
"""Film edge and what a pilot would choose, as none runs for so few samples. Together they have surfaces,
media, glass, textures, a picture of the sky, a million triangles, and photons from both ends."""

_SAMPLES = 64
# Of LLVM 19, as the compiler.
_MERGE = "llvm-profdata-19"


def main() -> None:
    """Trace the scenes and write the profile, without the functions that nothing called."""
    with tempfile.TemporaryDirectory(prefix="nocturne-profile-") as name:
        folder = Path(name)
        for scene, (edge, tracing) in SCENES.items():
            print(scene, flush=True)
            _count(scene, edge, tracing, folder / scene, folder / f"{scene}.profraw")
        run([_MERGE, "merge", "--sparse", *sorted(folder.glob("*.profraw")), "-o", PROFILE])
    print(f"{PROFILE.relative_to(CHECKOUT)}: {PROFILE.stat().st_size} bytes")


def _count(scene: str, edge: int, tracing: dict[str, Any], folder: Path, counts: Path) -> None:
    options = {"sharing": 1, **tracing}
    folder.mkdir()
    others = scenes()
    document = others[scene].write(folder) if scene in others else example(scene, folder)
    compiled = compile_document(document, folder, edge, _SAMPLES, options)
    os.environ["LLVM_PROFILE_FILE"] = str(counts)
    trace_to(compiled, folder / "image.exr", 1, program=COUNTING)


if __name__ == "__main__":
    main()
