"""Videos: animated WebP and GIF.

Pillow packs the pictures; its own writers of animations keep every picture in memory. Here a file grows by the
rectangle in which a picture differs from the one before, and no picture is kept:
docs/decisions/0202-videos-picture-by-picture.md.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping
from io import BytesIO
from itertools import chain, pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np
from PIL import Image, ImageChops, ImageColor
from PIL.GifImagePlugin import getdata, getheader

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND, Pixels
from clean_swarm_env.drawing.look import OPTION_COLOURS
from clean_swarm_env.drawing.picture import trail_colours
from selector.documents.writing import writing_to

MILLISECONDS: Final = 1000 // FRAMES_PER_SECOND
"""Time that a picture is shown."""
WEBP_QUALITY: Final = 60
MOST_OF_WEBP: Final = 2**32 - 2**26
"""Largest WebP file [byte]: its length is a number of 32 bits, and one more picture must fit."""
CLEAR: Final = 255
"""Number of the colour of a GIF that leaves what is behind it; the others are fewer."""


def write_video(output: Path, pictures: Iterator[Pixels]) -> None:
    """Write pictures (height, width, 3) of one even size as a video of 20 a second; the file appears whole at the end.

    Raises:
        ConfigurationError: the file cannot be written.
        OSError: the disk is full.

    """
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        folder = TemporaryDirectory(dir=output.parent, prefix=f".{output.stem}-")
    except OSError as error:
        raise ConfigurationError(f"{output}: cannot be written ({error.strerror})") from error
    with folder as place:
        part = Path(place) / f"part{output.suffix.lower()}"
        with writing_to(output):
            WRITERS[part.suffix](part, pictures)
        shutil.move(part, output)


def _changes(images: Iterator[Image.Image]) -> Iterator[tuple[tuple[int, int], Image.Image, Image.Image]]:
    """Yield where each picture of one size differs from the one before: an even corner, the part, the part before.

    The first picture is new as a whole; where nothing has changed the part is a pixel.
    """
    first = next(images)
    for before, now in pairwise(chain([ImageChops.invert(first), first], images)):
        left, top, right, bottom = ImageChops.difference(now, before).getbbox() or (0, 0, 1, 1)
        inside = (left // 2 * 2, top // 2 * 2, right, bottom)
        yield inside[:2], now.crop(inside), before.crop(inside)


def _write_webp(path: Path, pictures: Iterator[Pixels]) -> None:
    """Write pictures (H, W, 3) as an animated WebP: https://developers.google.com/speed/webp/docs/riff_container."""
    with path.open("wb") as file:
        for (left, top), part, _ in _changes(map(Image.fromarray, pictures)):
            size = _of_three_bytes(part.width - 1, part.height - 1)
            if not file.tell():
                animated = b"\x02\0\0\0"  # flags; what is animated is endless, before a black background
                file.write(b"RIFF    WEBP" + _chunk(b"VP8X", animated + size) + _chunk(b"ANIM", bytes(6)))
            packed = BytesIO()
            part.save(packed, "WEBP", quality=WEBP_QUALITY, method=2)
            place, time = _of_three_bytes(left // 2, top // 2), _of_three_bytes(MILLISECONDS)
            opaque, still = b"\x02", packed.getvalue()[len(b"RIFF....WEBP") :]  # a flag; the chunk of the picture
            file.write(_chunk(b"ANMF", place + size + time + opaque + still))
            if file.tell() > MOST_OF_WEBP:
                raise ConfigurationError("video: expected a WebP file of at most 4 GB; .gif takes more")
        length = file.tell() - 8
        file.seek(4)
        file.write(length.to_bytes(4, "little"))


def _write_gif(path: Path, pictures: Iterator[Pixels]) -> None:
    """Write pictures (H, W, 3) as an animated GIF in the colours that pictures have."""
    palette = Image.new("P", (1, 1))
    palette.putpalette(_colours())
    with path.open("wb") as file:
        for corner, part, before in _changes(_numbers(picture, palette) for picture in pictures):
            if not file.tell():
                file.writelines(getheader(palette.resize(part.size), info={"loop": 0})[0])
            part.paste(CLEAR, mask=ImageChops.difference(part, before).point(lambda step: 0 if step else 255))
            file.writelines(getdata(part, corner, duration=MILLISECONDS, transparency=CLEAR, disposal=1))
        file.write(b";")


def _colours() -> bytes:
    """Return red, green and blue of the colours of pictures, fewer than CLEAR."""
    flat = [ImageColor.getrgb(colour)[:3] for colour in OPTION_COLOURS]
    paler = [tuple((part + 255) // 2 for part in colour) for colour in flat]
    greys = [(level, level, level) for level in range(0, 256, 15)]
    return np.array([*flat, *paler, *greys, *trail_colours()[::2].tolist()], dtype=np.uint8).tobytes()


def _numbers(picture: Pixels, palette: Image.Image) -> Image.Image:
    """Return the numbers of the nearest colours; dots in between would make a GIF ten times as large."""
    return Image.fromarray(np.asarray(Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)))


def _chunk(kind: bytes, content: bytes) -> bytes:
    """Return a chunk of a WebP file, of even length."""
    return kind + len(content).to_bytes(4, "little") + content + bytes(len(content) % 2)


def _of_three_bytes(*numbers: int) -> bytes:
    return b"".join(number.to_bytes(3, "little") for number in numbers)


WRITERS: Final[Mapping[str, Callable[[Path, Iterator[Pixels]], None]]] = {".webp": _write_webp, ".gif": _write_gif}
"""Ending of a file -> function that writes it."""
