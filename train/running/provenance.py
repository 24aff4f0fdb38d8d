"""Origin of results: versions of the software, and fingerprints of the files on which a run depends."""

import hashlib
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from selector.documents.errors import DocumentError
from selector.documents.find import SHIPPED

PACKAGES = ("clean-swarm", "numpy", "numba", "pymunk", "scipy", "pydantic")
"""Packages that every result depends on."""
FINGERPRINTED = ("knowledge", "mechanisms", "robots")
"""Kinds of files on which a run depends, besides its configuration."""


def versions(more: Sequence[str] = (), needed_by: str = "results need", extra: str = "") -> dict[str, str]:
    """Return the versions of Python, of the packages that every result depends on, and of `more` packages.

    Raises:
        DocumentError: a package is not installed, which the `extra` has if there is one; `needed_by` begins the text.

    """
    try:
        return {"python": platform.python_version(), **{name: version(name) for name in (*PACKAGES, *more)}}
    except PackageNotFoundError as error:
        install = "pip install -c constraints.txt " + (f"'.[{extra}]'" if extra else ".")
        raise DocumentError(f"{needed_by} {error.name}, which is not installed: {install}") from error


def fingerprints(directories: Sequence[Path] = ()) -> dict[str, str]:
    """Return file -> SHA-256 of the fingerprinted files, both shipped and in the user's directories."""
    found = {}
    for root in (SHIPPED, *directories):
        for path in sorted(path for kind in FINGERPRINTED for path in (root / kind).glob("*.yaml")):
            name = (path.relative_to(root) if root == SHIPPED else path).as_posix()
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found
