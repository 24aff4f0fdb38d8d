"""Draws the layers as SVG: `python -m docs.figures.draw_architecture [DIR]` (default docs/pictures).

The layers inside a package are those of its contract in `pyproject.toml`.
"""

import sys
import tomllib
from html import escape
from pathlib import Path

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "docs" / "pictures"
INK, PALE, FLOOR, MINDS, BETWEEN = "#1b2a41", "#8d99ae", "#d9f0e6", "#d7e6f5", "#fbe3d4"
WIDTH, BOX, GAP = 760, 42, 16
LETTER = 0.53  # mean width of a letter, in sizes of its font

PACKAGES = {"train": BETWEEN, "clean_swarm_env": FLOOR, "selector": MINDS, "selforg": MINDS}
"""Package -> colour, from the top down."""
UNWRITTEN = {"selforg": "components > mechanisms > gradients | network > compiler > arrays"}
"""Layers of a package without a contract of its own."""


def text(x: float, y: float, words: str, size: float = 13, weight: str = "normal", colour: str = INK) -> str:
    """Return a centred line of text."""
    style = f'font-family="sans-serif" font-size="{size:g}" font-weight="{weight}" fill="{colour}"'
    return f'<text x="{x:g}" y="{y:g}" text-anchor="middle" {style}>{escape(words)}</text>'


def box(x: float, y: float, width: float, colour: str, title: str, words: str) -> list[str]:
    """Return a box with a title and a line below it."""
    frame = f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{BOX}" rx="6" fill="{colour}" stroke="{INK}"/>'
    middle, size = x + width / 2, min(11.0, round((width - 16) / max(len(words), 1) / LETTER, 1))
    return [frame, text(middle, y + 17, title, 13, "bold"), text(middle, y + 34, words, size)]


def arrow(x0: float, y0: float, x1: float, y1: float) -> str:
    """Return an arrow."""
    ends = f'x1="{x0:g}" y1="{y0:g}" x2="{x1:g}" y2="{y1:g}"'
    return f'<line {ends} stroke="{PALE}" stroke-width="1.5" marker-end="url(#tip)"/>'


def svg(height: float, parts: list[str]) -> str:
    """Return a picture of the parts."""
    tip = f'<path d="M0,0 L8,4 L0,8 z" fill="{PALE}"/>'
    marker = (
        f'<defs><marker id="tip" markerWidth="8" markerHeight="8" refX="7" refY="4" orient="auto">{tip}</marker></defs>'
    )
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:g}" width="{WIDTH}">'
    return "\n".join([head, '<rect width="100%" height="100%" fill="white"/>', marker, *parts, "</svg>"]) + "\n"


def inside(package: str) -> str:
    """Return the layers inside a package, from the top down; those of one layer do not import each other."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    found = [contract["layers"] for contract in contracts if contract.get("containers") == [package]]
    return " > ".join(found[0]) if found else UNWRITTEN.get(package, "")


def layers() -> str:
    """Return the picture of the layers; an import leads down only."""
    parts = []
    for number, (name, colour) in enumerate(PACKAGES.items()):
        y = 10 + number * (BOX + GAP)
        parts += box(20, y, WIDTH - 40, colour, name, inside(name))
        if number:
            parts.append(arrow(WIDTH / 2, y - GAP, WIDTH / 2, y))
    return svg(10 + len(PACKAGES) * (BOX + GAP), parts)


def main(directory: Path) -> None:
    """Write the picture into a directory."""
    (directory / "layers.svg").write_text(layers(), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURES)
