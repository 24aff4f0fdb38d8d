"""Writing files whole or not at all."""

import os
from pathlib import Path

from selector.documents.errors import DocumentError, shown


def write_whole(path: Path, content: bytes) -> None:
    """Write a file so that at any moment, also after a loss of power, the old or the new content is there.

    Raises:
        DocumentError: a place that cannot be written to.

    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with part.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        raise DocumentError(f"{shown(path)}: cannot be written ({error})") from error
