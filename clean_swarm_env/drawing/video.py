"""Videos: animated WebP and GIF, and with the extra `video` WebM (VP8) and MP4 (VP9) by OpenCV."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.drawing.animations import write_gif, write_webp
from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND
from clean_swarm_env.drawing.pixels import Pixels
from selector.documents.writing import writing_to

CODECS: Final = {".webm": "VP80", ".mp4": "vp09"}
"""Codecs of OpenCV by the ending of the file; both store yuv420p, and neither is under the GPL.

Why no H.264: docs/decisions/0202-videos-picture-by-picture.md."""
SUFFIXES: Final = (".webp", ".gif", *CODECS)


def check_video(output: Path) -> None:
    """Raise ConfigurationError if no video can be written to a file of this name."""
    suffix = output.suffix.lower()
    if suffix not in SUFFIXES:
        raise ConfigurationError(f"{output}: expected a name that ends with {', '.join(SUFFIXES)}")
    if suffix in CODECS:
        _opencv(output)


def write_video(output: Path, pictures: Iterator[Pixels]) -> None:
    """Write pictures (height, width, 3) of one even size as a video of 20 a second; the file appears whole at the end.

    Raises:
        ConfigurationError: the file cannot be written.
        OSError: the disk is full.

    """
    writers: Mapping[str, Callable[[Path, Iterator[Pixels]], None]] = {".webp": write_webp, ".gif": write_gif}
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        folder = TemporaryDirectory(dir=output.parent, prefix=f".{output.stem}-")
    except OSError as error:
        raise ConfigurationError(f"{output}: cannot be written ({error.strerror})") from error
    with folder as place:
        part = Path(place) / f"part{output.suffix.lower()}"
        with writing_to(output):
            writers.get(part.suffix, _by_opencv)(part, pictures)
        if not part.exists():
            raise ConfigurationError(f"{output}: OpenCV could not write it whole (a full disk?); .webp needs no OpenCV")
        shutil.move(part, output)


def _by_opencv(path: Path, pictures: Iterator[Pixels]) -> None:
    """Write a video, and remove it if it cannot be read whole: of a full disk OpenCV says nothing."""
    cv2, first, count = _opencv(path), next(pictures), 0
    height, width, _ = first.shape
    with _quiet():
        code = cv2.VideoWriter.fourcc(*CODECS[path.suffix])
        writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, code, float(FRAMES_PER_SECOND), (width, height))
    for count, picture in enumerate(chain([first], pictures), 1):  # noqa: B007  (the last count is used)
        writer.write(np.ascontiguousarray(picture[:, :, ::-1]))
    with _quiet():
        writer.release()
        if sum(iter(cv2.VideoCapture(str(path)).grab, False)) < count:
            path.unlink(missing_ok=True)


def _opencv(output: Path) -> Any:  # noqa: ANN401  (a module that may be missing)
    try:
        import cv2
    except ImportError as error:
        needed = "OpenCV, which is not installed: pip install 'clean-swarm[video]'; .webp and .gif need none"
        raise ConfigurationError(f"{output}: needs {needed}") from error
    return cv2


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep the standard error still: OpenCV writes there that WebM has no tag for VP8, which is no mistake."""
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)
