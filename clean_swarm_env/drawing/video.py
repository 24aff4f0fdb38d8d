"""Videos: WebP and GIF by Pillow, WebM (VP8) and MP4 (VP9) by OpenCV, which comes with the extra `video`."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
from PIL import Image, ImageColor

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND, OPTION_COLOURS, STATIONS
from clean_swarm_env.drawing.pixels import Pixels, trail_colours

CODECS: Final = {".webm": "VP80", ".mp4": "vp09"}
"""Codecs of OpenCV by the ending of the file; both store yuv420p, and neither is under the GPL."""
SUFFIXES: Final = (".webp", ".gif", *CODECS)
MOST_OF_GIF: Final = 2000
"""Pictures of a GIF, which Pillow keeps in memory."""
WEBP_QUALITY: Final = 60


def check_video(output: Path, count: int) -> None:
    """Raise ConfigurationError if a video of so many pictures cannot be written to this file."""
    suffix = output.suffix.lower()
    if suffix not in SUFFIXES:
        raise ConfigurationError(f"{output}: expected a name that ends with {', '.join(SUFFIXES)}")
    if suffix == ".gif" and count > MOST_OF_GIF:
        raise ConfigurationError(
            f"{output}: expected at most {MOST_OF_GIF} pictures in a GIF, got {count}; --from, --to and --speed make "
            "fewer, .webp takes any number"
        )
    if suffix in CODECS:
        _opencv(output)


def write_video(output: Path, pictures: Iterator[Pixels]) -> None:
    """Write pictures (height, width, 3) of one even size as a video of 20 a second; the file appears whole at the end.

    Raises:
        ConfigurationError: the file cannot be written.
        OSError: the disk is full.

    """
    write: Callable[[Path, Iterator[Pixels]], None] = _by_opencv if output.suffix.lower() in CODECS else _by_pillow
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        folder = TemporaryDirectory(dir=output.parent, prefix=f".{output.stem}-")
    except OSError as error:
        raise ConfigurationError(f"{output}: cannot be written ({error.strerror})") from error
    with folder as place:
        part = Path(place) / f"part{output.suffix.lower()}"
        write(part, pictures)
        if not part.exists() or not part.stat().st_size:
            raise ConfigurationError(f"{output}: cannot be written by OpenCV; .webp needs none")
        shutil.move(part, output)


def _by_pillow(path: Path, pictures: Iterator[Pixels]) -> None:
    images: Iterator[Image.Image] = (Image.fromarray(picture) for picture in pictures)
    look: dict[str, Any] = {"quality": WEBP_QUALITY, "method": 2}
    if path.suffix == ".gif":
        images, look = _few_colours(images), {}
    time = 1000 // FRAMES_PER_SECOND
    next(images).save(path, save_all=True, append_images=images, duration=time, loop=0, **look)


def _few_colours(images: Iterator[Image.Image]) -> Iterator[Image.Image]:
    """Yield images in the colours that pictures have, without dots in between, which make a GIF ten times as large."""
    flat = [ImageColor.getrgb(colour)[:3] for colour in (*OPTION_COLOURS, *(colour for _, colour in STATIONS))]
    paler = [tuple((part + 255) // 2 for part in colour) for colour in flat]
    greys = [(level, level, level) for level in range(0, 256, 15)]
    held = np.array([*flat, *paler, *greys, *trail_colours()[::2].tolist()], dtype=np.uint8)
    colours = Image.new("P", (1, 1))
    colours.putpalette(held.tobytes())
    for image in images:
        yield image.quantize(palette=colours, dither=Image.Dither.NONE)


def _by_opencv(path: Path, pictures: Iterator[Pixels]) -> None:
    cv2, first = _opencv(path), next(pictures)
    height, width, _ = first.shape
    with _quiet():
        code = cv2.VideoWriter.fourcc(*CODECS[path.suffix])
        writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, code, float(FRAMES_PER_SECOND), (width, height))
    for picture in chain([first], pictures):
        writer.write(np.ascontiguousarray(picture[:, :, ::-1]))
    writer.release()


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
