"""Virtual environments of other people's packages, made where they do not exist yet."""

import subprocess
import sys
from pathlib import Path

from tests.paths import ROOT


def environment(place: Path, *packages: str) -> Path:
    """Return the Python of the virtual environment at `place`, with these packages; `pip` keeps to our constraints."""
    python = place / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", place], check=True)
    subprocess.run([python, "-m", "pip", "install", "-q", "-c", "constraints.txt", *packages], cwd=ROOT, check=True)
    return python
