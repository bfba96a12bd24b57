"""What the tracer does in examples, as the profile by which the compiler optimises: `make profile`.

A program that counts (`cmake --preset profile`) traces them with one thread, as its counters are not safe
between threads.
"""

import os
import tempfile
from pathlib import Path

from nocturne_client.local.programs import CHECKOUT

from bench.programs import run, trace_to
from bench.scenes import compile_document, example

PROFILE = CHECKOUT / "worker" / "tracing.profdata"
COUNTING = CHECKOUT / "build" / "profile" / "worker" / "nocturne-trace"

SCENES = {
    "cornell": 16,
    "fog": 1,
    "subsurface": 1,
    "sky": 1,
    "glossy_spheres": 1,
    "both_directions": 1,
    "mixtures": 1,
}
"""With the pixels that share, as no pilot runs for so few samples. Together they have surfaces, media, glass
and photons from both ends."""

_EDGE, _SAMPLES = 128, 64
# Of LLVM 19, as the compiler.
_MERGE = "llvm-profdata-19"


def main() -> None:
    """Trace the scenes and write the profile, without the functions that nothing called."""
    with tempfile.TemporaryDirectory(prefix="nocturne-profile-") as name:
        folder = Path(name)
        for scene, sharing in SCENES.items():
            print(scene, flush=True)
            _count(scene, sharing, folder / scene, folder / f"{scene}.profraw")
        run([_MERGE, "merge", "--sparse", *sorted(folder.glob("*.profraw")), "-o", PROFILE])
    print(f"{PROFILE.relative_to(CHECKOUT)}: {PROFILE.stat().st_size} bytes")


def _count(scene: str, sharing: int, folder: Path, counts: Path) -> None:
    compiled = compile_document(example(scene, folder), folder, _EDGE, _SAMPLES, {"sharing": sharing})
    os.environ["LLVM_PROFILE_FILE"] = str(counts)
    trace_to(compiled, folder / "image.exr", 1, program=COUNTING)


if __name__ == "__main__":
    main()
