"""Figures of the benchmarks in one file, so that two machines or two versions can be compared."""

import json
import os
import platform
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path

RESULTS = Path(__file__).parents[1] / "results.json"
PACKAGES = ("numpy", "numba", "pymunk")


def record(benchmark: str, figures: Mapping[str, Mapping[str, float]], others: Mapping[str, str] | None = None) -> None:
    """Put the figures of one benchmark into `results.json`, with the machine they are from; others stay as they are.

    `others` are versions of packages that are not ours.
    """
    own = {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}
    held = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
    held[benchmark] = {
        "machine": {"platform": platform.platform(), "cpu": _cpu(), "cores": os.cpu_count()},
        "versions": {**own, **(others or {})},
        **{what: {name: float(f"{value:.4g}") for name, value in values.items()} for what, values in figures.items()},
    }
    RESULTS.write_text(json.dumps(held, indent=2, sort_keys=True) + "\n", encoding="utf-8")


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
