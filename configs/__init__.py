"""Missions, mechanism configurations, expert knowledge, start configurations and experiments, shipped as data."""

from importlib.resources import files
from pathlib import Path


def directory() -> Path:
    """Return the directory of the shipped YAML files; they are plain files in a checkout and in an installed wheel."""
    return Path(str(files(__name__)))
