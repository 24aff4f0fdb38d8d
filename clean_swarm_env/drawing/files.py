"""Files of pictures: SVG as text, PNG and WebP by Pillow."""

from io import BytesIO
from pathlib import Path
from typing import Final

from PIL import Image

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.drawing.canvas import Canvas
from clean_swarm_env.drawing.layout import layout_of
from clean_swarm_env.drawing.pixels import laid_out
from clean_swarm_env.drawing.svg import svg_of
from selector.documents.writing import write_whole

FORMATS: Final = (".svg", ".png", ".webp")


def check_picture(output: Path) -> None:
    """Raise ConfigurationError if there is no such kind of pictures."""
    if output.suffix.lower() not in FORMATS:
        raise ConfigurationError(f"{output}: expected a name that ends with {', '.join(FORMATS)}")


def write_picture(canvas: Canvas, output: Path, side: int) -> None:
    """Write a picture whose world has a longer side of about `side` [pixels].

    Raises:
        DocumentError: the file cannot be written.

    """
    layout, suffix = layout_of(canvas, side), output.suffix.lower()
    if suffix == ".svg":
        write_whole(output, svg_of(layout).encode())
        return
    packed = BytesIO()
    Image.fromarray(laid_out(layout)).save(packed, suffix.removeprefix(".").upper(), lossless=True)
    write_whole(output, packed.getvalue())
