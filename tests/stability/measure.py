"""One cell of the matrix: a case by a method."""

import json
import resource
import signal
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.programs import need_program

from bench.programs import BASELINE, bench_program
from bench.ways import Way
from tests.accuracy.spectral_meters import Y_PER_RADIANCE
from tests.stability.case import Case
from tests.stability.verdict import Verdict, Word, judge
from tests.system.images import Image

EDGE = 8
"""Of the film, pixels."""

TIME_LIMIT_S = 60.0
"""Of one run, seconds of the processor."""

_MORE, _MORE_TIME_S = 8.0, 3.0
"""A second look takes this many times the samples of the first, but hardly more than so many CPU seconds."""

_SHRUNK = 0.75
"""A deviation that falls to this part of itself with more samples is no bias: rare light was missed."""


def measure(case: Case, method: Way, folder: Path, threads: int = 2) -> Verdict:
    """The verdict on a case by a method; files go into `folder`, which may be new.

    A deviation is looked at again with up to 8 times the samples and other random numbers: one that goes
    away or becomes smaller is noise with a heavy tail, one that stays is a bias.
    """
    if not method.applies(case.document):
        return Verdict(Word.NOT_APPLICABLE)
    samples = max(1, round(case.samples * method.samples))
    first = _look(case, method, folder, samples, 0, threads)
    more = min(_MORE, _MORE_TIME_S / max(first.cpu_s, 1e-3))
    if first.word not in (Word.BIASED, Word.NOISY, Word.NOTHING) or case.truth == 0.0 or more < 2.0:
        return first
    again = _look(case, method, folder, round(more * samples), 1, threads)
    return replace(_of_both(first, again), cpu_s=first.cpu_s + again.cpu_s)


def _of_both(first: Verdict, again: Verdict) -> Verdict:
    """The second, unless what changed since the first says more."""
    if first.off is None or again.off is None or again.word is Word.NOTHING:
        return again
    if first.word is Word.BIASED and abs(again.off) <= _SHRUNK * abs(first.off):
        said = f"heavy tail: off by {first.off:+.2g} at first, by {again.off:+.2g} with more samples"
        return replace(again, word=Word.NOISY, said=said)
    return again


def _look(case: Case, method: Way, folder: Path, samples: int, seed: int, threads: int) -> Verdict:
    document = method.document(case.document)
    document["tracing"]["seed"] = seed
    folder.mkdir(parents=True, exist_ok=True)
    case.files(folder)
    scene = folder / "scene.json"
    scene.write_text(json.dumps(document))
    try:
        compiled = compile_to(scene, folder, EDGE, EDGE, samples)
    except NocturneClientError as error:
        first = error.problems[0] if error.problems else error
        return Verdict(Word.REFUSED, said=str(first))
    if case.truth is None:
        return Verdict(Word.ACCEPTED, said="it was compiled")
    verdict = _trace(case, case.truth, method, compiled, folder, threads)
    return replace(verdict, warned=bool(compiled.warnings))


def _trace(
    case: Case, truth: float, method: Way, compiled: CompiledFolder, folder: Path, threads: int
) -> Verdict:
    output, statistics = folder / "image.exr", folder / "statistics.json"
    program = bench_program(BASELINE) if method.baseline else need_program("nocturne-trace")
    command: list[object] = [program, compiled.scene, "-o", output, "--quiet"]
    command += ["--schedule", compiled.schedule, "--blobs", compiled.blobs, "--statistics", statistics]
    command += ["--threads", threads, *method.baseline]
    before = _cpu_s()
    limit = ["prlimit", f"--cpu={TIME_LIMIT_S:.0f}", "--"]
    done = subprocess.run([*limit, *map(str, command)], capture_output=True, text=True, check=False)
    cpu_s = _cpu_s() - before
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return Verdict(Word.FAILED, said=f"no end after {TIME_LIMIT_S:g} CPU s", cpu_s=cpu_s)
    if done.returncode < 0:
        return Verdict(Word.FAILED, said=f"ended by signal {-done.returncode}", cpu_s=cpu_s)
    if done.returncode > 0:
        return Verdict(Word.REFUSED, said=done.stderr.strip()[-200:], cpu_s=cpu_s)
    invalid_samples = json.loads(statistics.read_text())["invalid_samples"]
    if invalid_samples:
        return Verdict(Word.FAILED, said=f"{invalid_samples} photons were not finite", cpu_s=cpu_s)
    image = Image.read(output)
    pixels, own_errors = (np.asarray(each / Y_PER_RADIANCE, np.float64) for each in (image.y, image.y_error))
    if not np.isfinite(pixels).all():
        return Verdict(Word.FAILED, said="pixels are not finite", cpu_s=cpu_s)
    word, off, error = judge(pixels, own_errors, truth, case.allowed)
    return Verdict(word, off, error, cpu_s=cpu_s)


def _cpu_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
