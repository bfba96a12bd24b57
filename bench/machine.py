"""Names the machine of a measurement."""

import os
from pathlib import Path


def processor() -> str:
    """Model and number of processors."""
    models = [
        line.partition(":")[2].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    return f"{os.cpu_count()} x {models[0] if models else 'unknown'}"


def load_average() -> float:
    """Of the last minute: above the number of processors, others were waiting too."""
    return round(os.getloadavg()[0], 2)
