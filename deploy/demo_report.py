"""The last lines of `make demo`: the image, its place, the meaning of its error, and how to reduce it.

python3 deploy/demo_report.py RENDER.json URL, with the render as `nocturne get --json` writes it.
"""

import json
import math
import os
import sys
from pathlib import Path
from typing import Any

_MORE = 16
"""Times as many samples: their square root, 4, is what the error falls by."""


def report(render: dict[str, Any], image: Path, url: str) -> str:
    """Lines for first-time users; the picture lies next to `image`."""
    progress, film = render["progress"], f"{render['width']} x {render['height']} pixels"
    samples = render["samples"]
    minutes = (_MORE - 1) * progress["cpu_seconds"] / (60.0 * len(os.sched_getaffinity(0)))
    return f"""
Rendered: the Cornell box, {film} with {samples} samples each, from its measured spectra.

  picture, to look at:        {image.with_suffix(".png")}
  image, to measure:          {image}
                              (X, Y, Z with standard errors; Y is luminance in cd/m2)
  page, to explore it:        {url}/#/renders/{render["id"]}

{_error(progress, render["unit"])}

A better one: {_MORE} times as many samples have a quarter of the error. The present samples are kept, the
rest takes {_duration(minutes)} on this machine; watch it on the page:

  {_where(url)}.venv/bin/nocturne extend {render["id"]} --samples {_MORE * samples}

The service goes on; end it with: make stop"""


def _error(progress: dict[str, Any], unit: str) -> str:
    """The error, in plain words."""
    error, mean, interval = progress["relative_error"], progress["mean"], 1.96 * progress["mean_error"]
    if not error:
        return "How far the image is off is not known yet."
    digits = max(0, 1 - math.floor(math.log10(interval))) if interval > 0.0 else 0
    lines = [
        f"Its error: a pixel is off by about {100.0 * error:.2g} % of its luminance, the grain that you see.",
        f"The mean of all is known much better: {mean:.{digits}f} +- {interval:.{digits}f} {unit} (95 %).",
    ]
    if progress["doubt"]:
        lines += [
            "Both are estimates from the same samples, and may be too small:",
            f"{progress['doubt']} That is usual for a first look; more samples help.",
        ]
    return "\n".join(lines)


def _duration(minutes: float) -> str:
    return "less than a minute" if minutes < 1.0 else f"about {math.ceil(minutes)} minutes"


def _where(url: str) -> str:
    """The setting for the command line, if the service is not at the default address."""
    return "" if url == "http://127.0.0.1:7070" else f"NOCTURNE_URL={url} "


if __name__ == "__main__":
    _, found, service = sys.argv
    told = report(json.loads(Path(found).read_text()), Path(found).with_suffix(".exr").absolute(), service)
    sys.stdout.write(told + "\n")
