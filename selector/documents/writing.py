"""Writing files whole or not at all."""

import errno
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import rmtree

from selector.documents.plain import DocumentError, shown

DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Numbers of the errors of a full disk, which is not the user's mistake: they stay an OSError."""


@contextmanager
def writing_to(path: Path, *, anew: bool = False) -> Iterator[None]:
    """Let errors of writing name a file, as those of a full disk do not, and remove what was begun `anew`."""
    try:
        yield
    except OSError as error:
        error.filename = str(path)
        if anew:
            rmtree(path, ignore_errors=True)
            path.unlink(missing_ok=True)
        raise


def check_output(path: Path, endings: Collection[str], *, new: bool = False, hint: str = "") -> None:
    """Raise DocumentError for a file with another ending, or for one that is there where a `new` one is expected.

    The folder of a file is made when it is written. That of a new file may not be written in capitals.
    """
    if (path.suffix if new else path.suffix.lower()) not in endings:
        raise DocumentError(f"{path}: expected a name that ends with {', '.join(endings)}{hint}")
    if new and path.exists():
        raise DocumentError(f"{path}: exists already; expected a new file")


def write_whole(path: Path, content: bytes) -> None:
    """Write a file whole: at any moment, also after a loss of power, it has its old or its new content.

    Raises:
        DocumentError: the file cannot be written.
        OSError: the disk is full.

    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with writing_to(path), part.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        if error.errno in DISK_FULL:
            raise
        raise DocumentError(f"{shown(path)}: cannot be written ({error.strerror or error})") from error


def remove_parts(directory: Path) -> None:
    """Remove the parts of files in a directory whose writers were killed; parts of living processes stay."""
    for part in directory.glob(".*.part"):
        maker = part.name.split(".")[-2]
        if maker.isdecimal() and not _lives(int(maker)):
            part.unlink(missing_ok=True)


def _lives(process: int) -> bool:
    """Return whether a process runs; True where this cannot be known."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)  # sends nothing
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True
