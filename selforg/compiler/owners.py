"""Whose compiled code may run: it runs as whoever loads it, so nothing is loaded that another user may have written.

Trusted are the user, root, and the owner of the package, whose sources run anyway
(docs/decisions/0210-owners-of-compiled-code.md).
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


def doubt_about(place: Path) -> str:
    """Return why compiled code in a folder is not to be used; nothing if only trusted users may have written it.

    The folder, all that is in it, and the folders above count: who may rename a folder may put another one there.
    """
    on_windows = not hasattr(os, "getuid")  # there a user's folders are closed to others
    return "" if on_windows else next(_doubts(place.resolve()), "")


def _doubts(whole: Path) -> Iterator[str]:
    trusted = {os.getuid(), 0, PACKAGE.stat().st_uid}
    above = [(path, stat.S_ISVTX) for path in whole.parents if path not in PACKAGE.parents]  # they hold our sources
    closed = 0 if whole.stat().st_mode & 0o077 else 0o022
    within = [(Path(top, name), closed) for top, folders, files in os.walk(whole) for name in (*folders, *files)]
    for path, excuse in (*above, (whole, 0), *within):
        with suppress(FileNotFoundError):  # another process has just removed it
            found = path.lstat()
            if found.st_uid not in trusted:
                yield f"{path} belongs to user {found.st_uid}"
            elif found.st_mode & 0o022 and not found.st_mode & excuse:
                yield f"others may write {path}"
