"""Writing files whole or not at all."""

import os
from pathlib import Path

from selector.documents.errors import DocumentError, shown


def write_whole(path: Path, content: bytes) -> None:
    """Write a file whole: at any moment, also after a loss of power, it has its old or its new content.

    Raises:
        DocumentError: the file cannot be written.

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
