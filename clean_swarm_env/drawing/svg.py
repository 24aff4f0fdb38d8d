"""Pictures as SVG."""

from base64 import b64encode
from html import escape
from io import BytesIO

import numpy as np
from PIL import Image

from clean_swarm_env.drawing.layout import Caption, Disc, Layout, Shape
from clean_swarm_env.drawing.pixels import EDGE, trail_colours


def svg_of(layout: Layout) -> str:
    """Return the picture of a layout as the text of an SVG file."""
    left, top, width, height = layout.world
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{layout.width}" height="{layout.height}" '
        f'viewBox="0 0 {layout.width} {layout.height}" font-family="sans-serif">',
        f'<rect width="{layout.width}" height="{layout.height}" fill="#ffffff"/>',
        f'<svg x="{left}" y="{top}" width="{width}" height="{height}">',
        _trail(layout),
        *map(_element, layout.inside),
        f'<rect width="{width}" height="{height}" fill="none" stroke="{EDGE}" stroke-width="2"/>',
        "</svg>",
        *map(_element, layout.shapes),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _trail(layout: Layout) -> str:
    """Return the pheromones as a small picture, a cell wider on each side, so that smoothing hides the seam."""
    _, _, width, height = layout.world
    lines, columns = layout.trail.shape
    across, up, packed = width / columns, height / lines, BytesIO()
    strength = np.pad(layout.trail[::-1], 1, mode="wrap")
    Image.fromarray(trail_colours()[(strength * 255.0).astype(np.uint8)]).save(packed, "PNG")
    cells = f'x="{-across:.2f}" y="{-up:.2f}" width="{width + 2 * across:.2f}" height="{height + 2 * up:.2f}"'
    data = b64encode(packed.getvalue()).decode()
    return f'<image {cells} preserveAspectRatio="none" href="data:image/png;base64,{data}"/>'


def _element(shape: Shape) -> str:
    if isinstance(shape, Disc):
        opacity = f' fill-opacity="{shape.share:g}"' if shape.share < 1.0 else ""
        return f'<circle cx="{shape.x:.2f}" cy="{shape.y:.2f}" r="{shape.radius:.2f}" fill="{shape.colour}"{opacity}/>'
    if isinstance(shape, Caption):
        anchor = ' text-anchor="middle" font-weight="bold"' if shape.centred else ""
        place = f'x="{shape.x:.2f}" y="{shape.y + 0.35 * shape.size:.2f}" font-size="{shape.size:g}"'
        return f'<text {place} fill="{shape.colour}"{anchor}>{escape(shape.text)}</text>'
    corners = " ".join(f"{x:.2f},{y:.2f}" for x, y in shape.corners)
    return f'<polygon points="{corners}" fill="{shape.colour}"/>'
